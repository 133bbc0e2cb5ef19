// Measures the point features on a sequence in the layout of TUM RGB-D: time per stage, and, where
// the true poses are known, how many matches between frames obey them.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/LU>
#include <fmt/core.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/base/camera_file.h"
#include "core/features/matcher.h"
#include "core/features/orb_extractor.h"

namespace vpslam {
namespace {

struct Frame {
  double stamp_s = 0;
  cv::Mat image;
  Features features;
  FeatureGrid grid;
  bool has_pose = false;
  SE3 cam_from_world;
};

double Median(std::vector<double> v) {
  if (v.empty()) return std::nan("");
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

std::vector<std::string> DataLines(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  }
  return lines;
}

std::vector<Frame> Load(const std::string& folder, int first, int count) {
  std::map<double, SE3> world_from_cam;
  for (const std::string& line : DataLines(folder + "/groundtruth.txt")) {
    std::istringstream in(line);
    double stamp_s, tx, ty, tz, qx, qy, qz, qw;
    if (in >> stamp_s >> tx >> ty >> tz >> qx >> qy >> qz >> qw) {
      world_from_cam[stamp_s] = SE3(Eigen::Quaterniond(qw, qx, qy, qz), {tx, ty, tz});
    }
  }
  std::vector<Frame> frames;
  const std::vector<std::string> lines = DataLines(folder + "/rgb.txt");
  const size_t end = std::min(lines.size(), static_cast<size_t>(first) + count);
  for (size_t i = first; i < end; ++i) {
    std::istringstream in(lines[i]);
    Frame frame;
    std::string name;
    in >> frame.stamp_s >> name;
    frame.image = cv::imread(folder + "/" + name, cv::IMREAD_GRAYSCALE);
    auto next = world_from_cam.lower_bound(frame.stamp_s - 0.02);
    if (next != world_from_cam.end() && next->first < frame.stamp_s + 0.02) {
      while (std::next(next) != world_from_cam.end() &&
             std::abs(std::next(next)->first - frame.stamp_s) <
                 std::abs(next->first - frame.stamp_s)) {
        ++next;
      }
      frame.has_pose = true;
      frame.cam_from_world = next->second.Inverse();
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Distances from the epipolar lines, in units of the scale of the second key point.
std::vector<double> EpipolarErrors(const Frame& a, const Frame& b, const Camera& camera,
                                   const ScalePyramid& scales, const std::vector<Match>& matches) {
  const SE3 b_from_a = b.cam_from_world * a.cam_from_world.Inverse();
  const Eigen::Matrix3d k_inverse = camera.K().inverse();
  const Eigen::Matrix3d fundamental = k_inverse.transpose() *
                                      Skew(b_from_a.translation.normalized()) *
                                      b_from_a.RotationMatrix() * k_inverse;
  std::vector<double> errors;
  for (const Match& m : matches) {
    const Keypoint &p = a.features.keypoints[m.first], &q = b.features.keypoints[m.second];
    const Eigen::Vector3d line = fundamental * p.Position().homogeneous();
    errors.push_back(std::abs(line.dot(q.Position().homogeneous())) / line.head<2>().norm() /
                     scales.scale(q.octave));
  }
  return errors;
}

/// Sums over many pairs of frames.
struct Tally {
  std::vector<double> matches, inliers, inlier_errors, cells, time_ms;
  void Add(const Frame& b, const std::vector<Match>& found, const std::vector<double>& errors,
           double ms) {
    constexpr double kInlier_px = 2.0;
    constexpr float kCell_px = 40;
    int n = 0;
    std::set<std::pair<int, int>> occupied;
    for (size_t i = 0; i < errors.size(); ++i) {
      if (errors[i] >= kInlier_px) continue;
      ++n;
      inlier_errors.push_back(errors[i]);
      const Keypoint& k = b.features.keypoints[found[i].second];
      occupied.insert({static_cast<int>(k.x_px / kCell_px), static_cast<int>(k.y_px / kCell_px)});
    }
    cells.push_back(static_cast<double>(occupied.size()));
    matches.push_back(static_cast<double>(errors.size()));
    inliers.push_back(n);
    time_ms.push_back(ms);
  }
  void Print(const char* name) const {
    const double sum = std::accumulate(matches.begin(), matches.end(), 0.0);
    const double good = std::accumulate(inliers.begin(), inliers.end(), 0.0);
    fmt::print(
        "  {:<16} matches {:6.1f}  inliers {:6.1f}  ratio {:.3f}  cells {:5.1f}  error {:.3f} px  "
        "{:.2f} ms\n",
        name, sum / static_cast<double>(matches.size()), good / static_cast<double>(matches.size()),
        good / sum, Median(cells), Median(inlier_errors), Median(time_ms));
  }
};

/// Time of this thread on a processor, which other load disturbs less than the time of day.
double Now_ms() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

void MeasureMatching(const std::vector<Frame>& frames, int gap, const Camera& camera,
                     const ScalePyramid& scales) {
  Tally brute, initial, triangulation;
  for (size_t i = 0; i + gap < frames.size(); i += 5) {
    const Frame &a = frames[i], &b = frames[i + gap];
    if (!a.has_pose || !b.has_pose) continue;
    auto begin = Now_ms();
    std::vector<Match> matches = MatchByDescriptor(a.features.descriptors, b.features.descriptors);
    double ms = Now_ms() - begin;
    brute.Add(b, matches, EpipolarErrors(a, b, camera, scales, matches), ms);

    std::vector<Eigen::Vector2f> predicted_px;
    for (const Keypoint& k : a.features.keypoints) predicted_px.emplace_back(k.x_px, k.y_px);
    begin = Now_ms();
    matches = MatchForInitialisation(a.features, b.features, b.grid, predicted_px);
    ms = Now_ms() - begin;
    initial.Add(b, matches, EpipolarErrors(a, b, camera, scales, matches), ms);

    std::vector<int32_t> all_a(a.features.size()), all_b(b.features.size());
    std::iota(all_a.begin(), all_a.end(), 0);
    std::iota(all_b.begin(), all_b.end(), 0);
    begin = Now_ms();
    matches = MatchForTriangulation(a.features, all_a, b.features, all_b,
                                    b.cam_from_world * a.cam_from_world.Inverse(), camera, scales);
    ms = Now_ms() - begin;
    triangulation.Add(b, matches, EpipolarErrors(a, b, camera, scales, matches), ms);
  }
  if (brute.matches.empty()) return;
  fmt::print("{} frames apart\n", gap);
  brute.Print("by descriptor");
  initial.Print("initialisation");
  triangulation.Print("triangulation");
}

void Run(const std::string& folder, int first, int count, const OrbOptions& options) {
  cv::setNumThreads(1);
  const Camera camera = ReadCameraFile(folder + "/camera.yaml");
  const Camera::Bounds bounds = camera.UndistortedBounds();
  std::vector<Frame> frames = Load(folder, first, count);
  OrbExtractor extractor(camera, options);

  std::vector<double> total_ms, number, grid_ms;
  std::vector<OrbTimings> timings;
  for (Frame& frame : frames) {
    auto begin = Now_ms();
    frame.features = extractor.Extract(frame.image);
    total_ms.push_back(Now_ms() - begin);
    begin = Now_ms();
    frame.grid = FeatureGrid(frame.features.keypoints, bounds);
    grid_ms.push_back(Now_ms() - begin);
    timings.push_back(extractor.last_timings());
    number.push_back(frame.features.size());
  }
  const auto stage = [&](double OrbTimings::*member) {
    std::vector<double> v;
    for (const OrbTimings& t : timings) v.push_back(t.*member);
    return Median(v);
  };
  fmt::print("{}: {} frames, {} features (median; least {})\n", folder, frames.size(),
             Median(number), *std::min_element(number.begin(), number.end()));
  fmt::print(
      "ms, median: total {:.2f} = pyramid {:.2f} + detection {:.2f} + distribution {:.2f} + "
      "orientation {:.2f} + description {:.2f} + position {:.2f}; grid {:.3f}\n",
      Median(total_ms), stage(&OrbTimings::pyramid_ms), stage(&OrbTimings::detection_ms),
      stage(&OrbTimings::distribution_ms), stage(&OrbTimings::orientation_ms),
      stage(&OrbTimings::description_ms), stage(&OrbTimings::position_ms), Median(grid_ms));
  for (const int gap : {1, 5, 15}) MeasureMatching(frames, gap, camera, extractor.scales());
}

}  // namespace
}  // namespace vpslam

int main(int argc, char** argv) {
  CLI::App app("Time and matching quality of the point features on a sequence");
  std::string folder;
  int first = 0, count = 100;
  vpslam::OrbOptions options;
  app.add_option("folder", folder, "with rgb.txt, camera.yaml and groundtruth.txt")->required();
  app.add_option("--first", first, "frame to begin with");
  app.add_option("--frames", count, "number of frames");
  app.add_option("--features", options.num_features, "per frame");
  CLI11_PARSE(app, argc, argv);
  try {
    vpslam::Run(folder, first, count, options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "features_bench: {}\n", e.what());
    return 1;
  }
  return 0;
}
