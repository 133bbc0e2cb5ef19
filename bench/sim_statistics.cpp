// What a feature-based SLAM sees of a sequence: corners, lines, how long corners can be followed
// and how well they are recognised. For comparing simulated images with photographs; the table in
// docs/simulator.md is made with it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/features/orb_extractor.h"
#include "core/geometry/so3.h"
#include "player/source_factory.h"

namespace {

using namespace vpslam;

constexpr int kMaxHamming = 64;
constexpr double kEpipolar_px = 2;
constexpr double kWindow_px = 60;     // between successive frames
constexpr int kTrackFrames = 30;      // length of the pieces in which corners are followed
constexpr int kGaps[] = {1, 10, 30};  // frames between matched images

struct Frame {
  int64_t stamp_us = 0;
  cv::Mat grey;
  Features features;
  std::optional<SE3> world_from_cam;
};

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(q * (values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// A figure per frame; printed as its mean over the frames.
struct Row {
  std::string name;
  std::vector<double> values;
};

class Table {
 public:
  void Add(const std::string& name, double value) {
    if (!std::isfinite(value)) return;
    for (Row& row : rows_) {
      if (row.name == name) return row.values.push_back(value);
    }
    rows_.push_back({name, {value}});
  }
  void Print() const {
    for (const Row& row : rows_) fmt::print("| {} | {:.3g} |\n", row.name, Mean(row.values));
  }

 private:
  std::vector<Row> rows_;
};

/// Standard deviation of white noise, from a mask that annihilates planes [Immerkaer, "Fast noise
/// variance estimation", CVIU 1996], at the smooth and well exposed half of the pixels.
double NoiseSigma(const cv::Mat& grey, const cv::Mat1f& gradient, double median_gradient) {
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat1f response;
  cv::filter2D(grey, response, CV_32F, kernel);
  std::vector<double> magnitudes;
  for (int y = 1; y + 1 < grey.rows; ++y) {
    for (int x = 1; x + 1 < grey.cols; ++x) {
      const int level = grey.at<uint8_t>(y, x);
      if (gradient(y, x) > median_gradient || level < 20 || level > 235) continue;
      magnitudes.push_back(std::abs(response(y, x)));
    }
  }
  // Mean of |N(0, 36 sigma^2)|.
  return Mean(magnitudes) * std::sqrt(std::numbers::pi / 2) / 6;
}

void MeasureImage(const cv::Mat& grey, Table* table) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  table->Add("grey level, mean", mean[0]);
  table->Add("grey level, standard deviation", deviation[0]);
  cv::Mat1f dx, dy, gradient;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 3, 1 / 8.0);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 3, 1 / 8.0);
  cv::magnitude(dx, dy, gradient);
  const std::vector<double> all(gradient.begin(), gradient.end());
  const double median = Quantile(all, 0.5);
  table->Add("gradient, median (grey levels/px)", median);
  table->Add("gradient, 90 % (grey levels/px)", Quantile(all, 0.9));
  table->Add("gradient, 99 % (grey levels/px)", Quantile(all, 0.99));
  table->Add("noise (grey levels)", NoiseSigma(grey, gradient, median));

  for (const int threshold : {7, 20}) {
    std::vector<cv::KeyPoint> corners;
    cv::FAST(grey, corners, threshold, true);
    table->Add(fmt::format("FAST corners, threshold {}", threshold),
               static_cast<double>(corners.size()));
    if (threshold != 20) continue;
    constexpr int kCell = 32;
    const int columns = (grey.cols + kCell - 1) / kCell, rows = (grey.rows + kCell - 1) / kCell;
    std::vector<char> occupied(static_cast<size_t>(columns) * rows, 0);
    for (const cv::KeyPoint& corner : corners) {
      occupied[static_cast<int>(corner.pt.y) / kCell * columns +
               static_cast<int>(corner.pt.x) / kCell] = 1;
    }
    table->Add("32 px cells with such a corner (%)",
               100.0 * std::count(occupied.begin(), occupied.end(), 1) / occupied.size());
  }

  std::vector<cv::Vec4f> lines;
  cv::createLineSegmentDetector()->detect(grey, lines);
  int long_lines = 0, longer_lines = 0;
  double total = 0;
  for (const cv::Vec4f& l : lines) {
    const double length = std::hypot(l[2] - l[0], l[3] - l[1]);
    total += length;
    long_lines += length >= 30;
    longer_lines += length >= 80;
  }
  table->Add("LSD segments", static_cast<double>(lines.size()));
  table->Add("LSD segments of 30 px and more", long_lines);
  table->Add("LSD segments of 80 px and more", longer_lines);
  table->Add("LSD length, mean (px)", total / std::max<size_t>(1, lines.size()));
}

struct Match {
  int a = 0, b = 0, hamming = 0, second = 0;
};

/// Best partner in b for each feature of a, where each is the other's best; `window_px` 0:
/// anywhere.
std::vector<Match> MutualMatches(const Features& a, const Features& b, double window_px) {
  const auto best = [window_px](const Features& from, const Features& to) {
    std::vector<Match> matches(from.size());
    for (int i = 0; i < from.size(); ++i) {
      matches[i] = {i, -1, 257, 257};
      for (int j = 0; j < to.size(); ++j) {
        if (window_px > 0 &&
            (from.keypoints[i].Position() - to.keypoints[j].Position()).norm() > window_px) {
          continue;
        }
        const int d = Distance(from.descriptors[i], to.descriptors[j]);
        if (d < matches[i].hamming) {
          matches[i].second = matches[i].hamming;
          matches[i].hamming = d;
          matches[i].b = j;
        } else {
          matches[i].second = std::min(matches[i].second, d);
        }
      }
    }
    return matches;
  };
  const std::vector<Match> forward = best(a, b), backward = best(b, a);
  std::vector<Match> mutual;
  for (const Match& m : forward) {
    if (m.b >= 0 && m.hamming <= kMaxHamming && backward[m.b].b == m.a) mutual.push_back(m);
  }
  return mutual;
}

/// Whether a match agrees with the true motion, as far as that shows: distance from the epipolar
/// line.
bool FitsTruth(const Frame& a, const Frame& b, const Match& m, const Camera& camera) {
  const SE3 b_from_a = b.world_from_cam->Inverse() * *a.world_from_cam;
  const Eigen::Vector3d ray_a = camera.Unproject(a.features.keypoints[m.a].Position());
  const Eigen::Vector3d line_normal = b_from_a.translation.cross(b_from_a.rotation * ray_a);
  const Eigen::Vector3d line(line_normal.x() / camera.fx, line_normal.y() / camera.fy,
                             line_normal.z() - line_normal.x() * camera.cx / camera.fx -
                                 line_normal.y() * camera.cy / camera.fy);
  const double distance = std::abs(line.dot(b.features.keypoints[m.b].Position().homogeneous())) /
                          line.head<2>().norm();
  return distance < kEpipolar_px;
}

void MeasureMatches(const std::vector<Frame>& frames, size_t first, const Camera& camera,
                    Table* table) {
  for (const int gap : kGaps) {
    if (first + gap >= frames.size()) continue;
    const Frame &a = frames[first], &b = frames[first + gap];
    if (!a.world_from_cam || !b.world_from_cam || a.features.size() == 0) continue;
    std::vector<double> hamming, ratio;
    const std::vector<Match> matches =
        MutualMatches(a.features, b.features, gap == 1 ? kWindow_px : 0);
    for (const Match& m : matches) {
      if (!FitsTruth(a, b, m, camera)) continue;
      hamming.push_back(m.hamming);
      if (m.second <= 256) ratio.push_back(static_cast<double>(m.hamming) / m.second);
    }
    const std::string after = fmt::format(" after {} frames", gap);
    table->Add("ORB features matched" + after + " (%)",
               100.0 * static_cast<double>(hamming.size()) / a.features.size());
    table->Add("matches that fit the true motion" + after + " (%)",
               100.0 * static_cast<double>(hamming.size()) / std::max<size_t>(1, matches.size()));
    table->Add("Hamming distance, median" + after, Quantile(hamming, 0.5));
    table->Add("best by second best distance, median" + after, Quantile(ratio, 0.5));
  }
}

/// Follows the features of frames[first] from frame to frame by mutual best matches.
void MeasureTracks(const std::vector<Frame>& frames, size_t first, Table* table) {
  const Features& start = frames[first].features;
  if (start.size() == 0) return;
  std::vector<int> where(start.size());
  for (int i = 0; i < start.size(); ++i) where[i] = i;
  double total = 0;
  for (int step = 1; step <= kTrackFrames; ++step) {
    const Features &a = frames[first + step - 1].features, &b = frames[first + step].features;
    std::vector<int> next(a.size(), -1);
    for (const Match& m : MutualMatches(a, b, kWindow_px)) next[m.a] = m.b;
    int alive = 0;
    for (int& w : where) {
      if (w >= 0) w = next[w];
      alive += w >= 0;
    }
    total += alive;
    const double share = 100.0 * alive / start.size();
    if (step == 5 || step == 15 || step == kTrackFrames) {
      table->Add(fmt::format("ORB features followed over {} frames (%)", step), share);
    }
  }
  table->Add(fmt::format("track length, mean, cut at {} (frames)", kTrackFrames),
             total / start.size());
}

void MeasureMotion(const std::vector<Frame>& frames, Table* table) {
  std::vector<double> metres, degrees;
  double path = 0;
  for (size_t i = 1; i < frames.size(); ++i) {
    const Frame &a = frames[i - 1], &b = frames[i];
    if (!a.world_from_cam || !b.world_from_cam) continue;
    const double seconds = 1e-6 * static_cast<double>(b.stamp_us - a.stamp_us);
    const SE3 motion = b.world_from_cam->Inverse() * *a.world_from_cam;
    path += motion.translation.norm();
    metres.push_back(motion.translation.norm() / seconds);
    degrees.push_back(LogSo3(motion.rotation).norm() * 180 / std::numbers::pi / seconds);
  }
  table->Add("path (m)", path);
  table->Add("speed, median (m/s)", Quantile(metres, 0.5));
  table->Add("turning, median (degrees/s)", Quantile(degrees, 0.5));
  table->Add("turning, 95 % (degrees/s)", Quantile(degrees, 0.95));
}

/// The image after compression: most photographs went through it, and it takes the finest noise.
cv::Mat Recompressed(const cv::Mat& grey, int jpeg_quality) {
  std::vector<uint8_t> bytes;
  cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
}

void Run(const std::string& sequence, const SourceOptions& options, int step, int jpeg_quality) {
  const auto source = OpenSource(sequence, options);
  const Camera camera = source->camera();
  OrbExtractor extractor(camera, {});
  std::vector<Frame> frames;
  while (auto frame = source->Next()) {
    if (jpeg_quality > 0) frame->grey = Recompressed(frame->grey, jpeg_quality);
    frames.push_back({frame->stamp_us, std::move(frame->grey), {}, {}});
    frames.back().world_from_cam = source->WorldFromCam(frames.back().stamp_us);
    frames.back().features = extractor.Extract(frames.back().grey);
  }
  Table table;
  table.Add("frames", static_cast<double>(frames.size()));
  MeasureMotion(frames, &table);
  for (size_t i = 0; i < frames.size(); i += step) {
    MeasureImage(frames[i].grey, &table);
    table.Add("ORB features (of 1000 wanted)", frames[i].features.size());
    MeasureMatches(frames, i, camera, &table);
  }
  for (size_t i = 0; i + kTrackFrames < frames.size(); i += 4 * step) {
    MeasureTracks(frames, i, &table);
  }
  fmt::print("| {} | mean over frames |\n|---|---|\n", sequence);
  table.Print();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Corner, line and tracking statistics of a sequence.");
  std::string sequence;
  SourceOptions options;
  int step = 20, jpeg_quality = 0;
  app.add_option("sequence", sequence, "folder, or sim:room and the like")->required();
  app.add_option("--frames", options.max_frames, "end after that many frames; 0: all");
  app.add_option("--step", step, "measure every so many frames")->check(CLI::PositiveNumber);
  app.add_option("--jpeg", jpeg_quality, "compress the images with this quality first; 0: don't")
      ->check(CLI::Range(0, 100));
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    Run(sequence, options, step, jpeg_quality);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
