// Vanishing points on a York-Urban-like folder: every method with every line detector, against the
// annotated truth. Prints a Markdown table and writes the directions found.
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/vp_metrics.h"
#include "bench/york_folder.h"
#include "core/base/cpu_stopwatch.h"
#include "core/base/decode_image.h"
#include "vpdetector/line_descriptor.h"
#include "vpdetector/line_extractor.h"
#include "vpdetector/vp_estimator.h"

namespace {

using namespace vpslam;
namespace fs = std::filesystem;

/// Standard deviation of an end point that a person set, across the segment.
constexpr double kAnnotationSigma_px = 1.0;

constexpr LineDetectorKind kDetectors[] = {LineDetectorKind::kEdLines, LineDetectorKind::kLsd,
                                           LineDetectorKind::kFld};
constexpr VpMethod kMethods[] = {VpMethod::kThreeLine, VpMethod::kTwoLineGrid,
                                 VpMethod::kTwoLineGridRaw};

/// One line of the table.
struct Row {
  std::string lines, method;
  VpErrors to_truth;
  VpErrors to_annotation;  ///< the directions that fit the annotated segments best
  std::vector<double> lines_ms, descriptors_ms, vps_ms;
  std::vector<Eigen::Matrix3d> found;
};

std::string Milliseconds(const std::vector<double>& values) {
  return values.empty() ? "-" : fmt::format("{:.2f}", Median(values));
}

std::string Format(const Row& row) {
  const bool annotated = row.to_annotation.images() > 0;
  return fmt::format(
      "| {} | {} | {:.1f} / {:.1f} / {:.1f} | {:.3f} | {:.2f} | {:.1f} | {} | {} | {} | {} |\n",
      row.lines, row.method, row.to_truth.AA(3), row.to_truth.AA(5), row.to_truth.AA(10),
      row.to_truth.MeanCapped_deg(), row.to_truth.MedianRotation_deg(),
      row.to_truth.ShareOver5_percent(),
      annotated ? fmt::format("{:.3f} / {:.2f}", row.to_annotation.MeanCapped_deg(),
                              row.to_annotation.MedianRotation_deg())
                : "-",
      Milliseconds(row.lines_ms), Milliseconds(row.descriptors_ms), Milliseconds(row.vps_ms));
}

nlohmann::ordered_json Figures(const Row& row) {
  const auto median = [](const std::vector<double>& values) {
    return values.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(Median(values));
  };
  return {{"lines", row.lines},
          {"method", row.method},
          {"aa_3_5_10", {row.to_truth.AA(3), row.to_truth.AA(5), row.to_truth.AA(10)}},
          {"mean_vp_error_deg", row.to_truth.MeanCapped_deg()},
          {"median_rotation_error_deg", row.to_truth.MedianRotation_deg()},
          {"over_5_deg_percent", row.to_truth.ShareOver5_percent()},
          {"lines_ms", median(row.lines_ms)},
          {"descriptors_ms", median(row.descriptors_ms)},
          {"vps_ms", median(row.vps_ms)}};
}

void WriteText(const fs::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) {
    throw std::runtime_error(path.string() + ": cannot be written; name a writable --out");
  }
}

/// A line per image: name and three directions x y z each, in camera axes.
void WriteDirections(const fs::path& file, const YorkFolder& york, const Row& row) {
  std::string out;
  for (size_t i = 0; i < york.images.size(); ++i) {
    out += york.images[i].name;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = row.found[i].col(k);
      out += fmt::format(" {:.8f} {:.8f} {:.8f}", d.x(), d.y(), d.z());
    }
    out += "\n";
  }
  WriteText(file, out);
}

/// True segments with true labels, least squares on SO(3): what truth and annotation allow.
/// `sigma_px` near 0 leaves the world's sigma alone, so that all segments weigh the same.
Row Ceiling(const YorkFolder& york, const std::string& name, double sigma_px,
            const VpOptions& options) {
  Row row{"annotated", name, {}, {}, {}, {}, {}, {}};
  for (const YorkImage& image : york.images) {
    std::vector<VpLine> lines;
    std::vector<int32_t> labels;
    for (const AnnotatedSegment& s : image.segments) {
      const auto line = MakeVpLine(york.camera, s.start_px, s.end_px, sigma_px, 1.0);
      if (!line) continue;
      lines.push_back(*line);
      labels.push_back(s.axis);
    }
    Eigen::Matrix3d start = image.truth;
    if (start.determinant() < 0) start.col(2) *= -1;
    row.found.push_back(FitLabelledLines(lines, labels, start, options.model).cam_from_manhattan);
    row.to_truth.Add(row.found.back(), image.truth);
  }
  return row;
}

std::vector<EdgeSegment> ToSegments(const std::vector<AnnotatedSegment>& annotated) {
  std::vector<EdgeSegment> segments;
  for (const AnnotatedSegment& s : annotated) {
    EdgeSegment segment;
    segment.start_px = s.start_px;
    segment.end_px = s.end_px;
    segment.sigma_px = kAnnotationSigma_px;
    segments.push_back(segment);
  }
  return segments;
}

void Run(const std::string& data, const std::string& out_folder, bool annotated) {
  const YorkFolder york = ReadYorkFolder(data);
  if (annotated && !york.has_segments) {
    throw std::runtime_error(data + "/lines.txt: is missing; --annotated needs it");
  }
  std::error_code error;
  fs::create_directories(out_folder, error);
  const fs::path out(out_folder);
  std::vector<cv::Mat> pixels;
  for (const YorkImage& image : york.images) {
    DecodedImage decoded = DecodeGrey(image.file);
    if (!decoded.fault.empty()) throw std::runtime_error(image.file + ": " + decoded.fault);
    if (decoded.grey.cols != york.camera.width || decoded.grey.rows != york.camera.height) {
      throw std::runtime_error(image.file + ": has another size than camera.yaml says");
    }
    pixels.push_back(decoded.grey);
  }

  std::vector<Row> rows;
  const Row* annotation = nullptr;
  rows.reserve(16);  // `annotation` points into it
  if (york.has_segments) {
    rows.push_back(Ceiling(york, "true labels, weights as in three_line", kAnnotationSigma_px, {}));
    annotation = &rows.back();
    rows.push_back(Ceiling(york, "true labels, equal weights", 1e-3, {}));
  }
  const auto add = [&](Row& row, size_t i, const Eigen::Matrix3d& found) {
    row.found.push_back(found);
    row.to_truth.Add(found, york.images[i].truth);
    if (annotation) row.to_annotation.Add(found, annotation->found[i]);
  };
  if (annotated) {
    for (const VpMethod method : kMethods) {
      Row row{"annotated", Name(method), {}, {}, {}, {}, {}, {}};
      VpOptions options;
      options.method = method;
      for (size_t i = 0; i < york.images.size(); ++i) {
        const std::vector<EdgeSegment> segments = ToSegments(york.images[i].segments);
        CpuStopwatch watch;
        const VpEstimate vps = EstimateVanishingPoints(segments, york.camera, options);
        row.vps_ms.push_back(watch.Lap_ms());
        add(row, i, vps.cam_from_manhattan);
      }
      WriteDirections(out / fmt::format("directions_{}_annotated.txt", Name(method)), york, row);
      rows.push_back(std::move(row));
    }
  }
  for (const LineDetectorKind kind : kDetectors) {
    LineExtractorOptions line_options;
    const bool default_lines = line_options.detector.kind == kind;
    line_options.detector.kind = kind;
    std::vector<Row> of_detector;
    for (const VpMethod method : kMethods) {
      of_detector.push_back({Name(kind), Name(method), {}, {}, {}, {}, {}, {}});
    }
    for (size_t i = 0; i < york.images.size(); ++i) {
      CpuStopwatch watch;
      const std::vector<EdgeSegment> segments = ExtractLines(pixels[i], york.camera, line_options);
      const double lines_ms = watch.Lap_ms();
      DescribeLines(pixels[i], york.camera, segments, LineDescriptorOptions());
      const double descriptors_ms = watch.Lap_ms();
      for (size_t m = 0; m < std::size(kMethods); ++m) {
        VpOptions options;
        options.method = kMethods[m];
        watch.Lap_ms();
        const VpEstimate vps = EstimateVanishingPoints(segments, york.camera, options);
        Row& row = of_detector[m];
        row.vps_ms.push_back(watch.Lap_ms());
        row.lines_ms.push_back(lines_ms);
        row.descriptors_ms.push_back(descriptors_ms);
        add(row, i, vps.cam_from_manhattan);
      }
    }
    for (size_t m = 0; m < std::size(kMethods); ++m) {
      WriteDirections(out / fmt::format("directions_{}_{}.txt", Name(kMethods[m]), Name(kind)),
                      york, of_detector[m]);
      if (default_lines && kMethods[m] == VpOptions().method) {
        WriteDirections(out / "directions.txt", york, of_detector[m]);
      }
      rows.push_back(std::move(of_detector[m]));
    }
  }

  std::string table = fmt::format(
      "{} images. Errors in degrees; times are medians in ms of CPU on one thread.\n\n"
      "| lines | method | AA@3/5/10 | mean VP error (capped at 10) | median rotation error | "
      "images over 5 (%) | to annotation: mean VP / median rotation | lines | descriptors | VPs "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n",
      york.images.size());
  auto figures = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    table += Format(row);
    figures.push_back(Figures(row));
  }
  std::cout << table;
  WriteText(out / "york.md", table);
  WriteText(out / "york.json", figures.dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures vanishing points on a York-Urban-like folder.");
  app.set_version_flag("--version", "york_bench " VPSLAM_VERSION);
  std::string data, out;
  bool annotated = false;
  app.add_option("--data", data, "folder with images/, manhattan.txt, camera.yaml, lines.txt")
      ->required();
  app.add_option("--out", out, "folder for directions*.txt, york.md and york.json; made if missing")
      ->required();
  app.add_flag("--annotated", annotated, "run the methods on the annotated segments, too");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  cv::setNumThreads(1);
  try {
    Run(data, out, annotated);
  } catch (const std::exception& e) {
    std::cerr << "york_bench: " << e.what() << "\n";
    return 1;
  }
  return 0;
}
