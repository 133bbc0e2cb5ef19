// Vanishing points of a whole sequence against its true rotations: how far off each image is, how
// honest its covariance, and what relative rotations come out once the axes were followed.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <exception>
#include <iostream>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "core/geometry/so3.h"
#include "frontend/axis_follower.h"
#include "player/source_factory.h"
#include "vpdetector/detector.h"

namespace {

using namespace vpslam;

constexpr double kDegPerRad = 180 / std::numbers::pi;

struct Seen {
  int64_t stamp_us = 0;
  std::optional<Eigen::Quaterniond> world_from_cam;  ///< truth
  LineSet lines;
  std::optional<Eigen::Quaterniond> followed;  ///< cam_from_manhattan, the measured one
  int generation = 0;
};

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
}

/// The rotation that turns `measured` into the nearest naming of the truth.
Eigen::Vector3d ErrorVector(const Eigen::Quaterniond& measured, const Eigen::Quaterniond& truth) {
  const Eigen::Matrix3d r = measured.toRotationMatrix();
  const Eigen::Matrix3d named = r * NearestNaming(r, truth.toRotationMatrix()).Matrix();
  return LogSo3(truth * Eigen::Quaterniond(named).conjugate());
}

/// world_from_manhattan that most images agree with, up to 5 degrees, refined over those.
std::optional<Eigen::Quaterniond> FitWorld(const std::vector<Seen>& frames) {
  constexpr double kAgree_deg = 5;
  std::vector<Eigen::Quaterniond> votes;
  for (const Seen& f : frames) {
    if (f.world_from_cam && f.lines.manhattan != ManhattanState::kNone) {
      votes.push_back(*f.world_from_cam * f.lines.cam_from_manhattan);
    }
  }
  const auto average = [&](const Eigen::Quaterniond& about, int* agreeing) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    *agreeing = 0;
    for (const Eigen::Quaterniond& vote : votes) {
      const Eigen::Vector3d e = ErrorVector(vote, about);
      if (e.norm() * kDegPerRad > kAgree_deg) continue;
      sum += (ExpSo3(-e) * about).toRotationMatrix();
      ++*agreeing;
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
  };
  std::optional<Eigen::Quaterniond> best;
  int most = 0, agreeing = 0;
  for (size_t i = 0; i < votes.size(); i += std::max<size_t>(1, votes.size() / 50)) {
    const Eigen::Quaterniond world = average(votes[i], &agreeing);
    if (agreeing <= most) continue;
    most = agreeing;
    best = world;
  }
  for (int round = 0; best && round < 5; ++round) best = average(*best, &agreeing);
  return best;
}

std::vector<Seen> Watch(ImageSource& source, const Detector& detector, AxisFollower& follower,
                        double turn_sigma_deg_per_frame, std::array<std::vector<double>, 3>* ms) {
  std::vector<Seen> frames;
  const double variance = std::pow(turn_sigma_deg_per_frame / kDegPerRad, 2);
  while (auto frame = source.Next()) {
    Seen seen;
    seen.stamp_us = frame->stamp_us;
    if (const auto truth = source.WorldFromCam(frame->stamp_us)) {
      seen.world_from_cam = truth->rotation;
    }
    seen.lines = detector.Detect(frame->grey);
    (*ms)[0].push_back(seen.lines.lines_ms);
    (*ms)[1].push_back(seen.lines.descriptors_ms);
    (*ms)[2].push_back(seen.lines.vps_ms);
    follower.Predict(Eigen::Quaterniond::Identity(), variance * Eigen::Matrix3d::Identity());
    const AxisFollower::Update update = follower.Take(seen.lines);
    if (update.outcome == AxisFollower::Outcome::kFollowed) {
      seen.followed = update.cam_from_manhattan;
      seen.generation = follower.generation();
    }
    frames.push_back(std::move(seen));
  }
  return frames;
}

void Report(const std::string& name, const std::vector<Seen>& frames, bool world_axes,
            const std::array<std::vector<double>, 3>& ms) {
  const auto count = [&](auto&& predicate) {
    return 100.0 * static_cast<double>(std::count_if(frames.begin(), frames.end(), predicate)) /
           static_cast<double>(frames.size());
  };
  const auto state = [&](ManhattanState s) {
    return count([s](const Seen& f) { return f.lines.manhattan == s; });
  };
  std::cout << fmt::format("## {}\n\n{} images\n", name, frames.size());
  std::cout << fmt::format(
      "- axes seen: three {:.1f} %, two {:.1f} %, none {:.1f} %; followed {:.1f} %, generations "
      "{}\n",
      state(ManhattanState::kThree), state(ManhattanState::kTwo), state(ManhattanState::kNone),
      count([](const Seen& f) { return f.followed.has_value(); }),
      frames.empty()
          ? 0
          : std::max_element(frames.begin(), frames.end(), [](const Seen& a, const Seen& b) {
              return a.generation < b.generation;
            })->generation);
  std::optional<Eigen::Quaterniond> world = Eigen::Quaterniond::Identity();
  if (!world_axes) world = FitWorld(frames);
  if (world) {
    std::vector<double> errors_deg, frontal_deg, nees;
    for (const Seen& f : frames) {
      if (!f.world_from_cam || f.lines.manhattan == ManhattanState::kNone) continue;
      const Eigen::Quaterniond truth = f.world_from_cam->conjugate() * *world;
      const Eigen::Vector3d e = ErrorVector(f.lines.cam_from_manhattan, truth);
      errors_deg.push_back(e.norm() * kDegPerRad);
      nees.push_back(e.dot(f.lines.covariance_rad2.ldlt().solve(e)));
      // Fronto-parallel: the optical axis within 5 degrees of an axis of the world.
      const double facing = truth.toRotationMatrix().row(2).cwiseAbs().maxCoeff();
      if (facing > std::cos(5 / kDegPerRad)) frontal_deg.push_back(e.norm() * kDegPerRad);
    }
    std::cout << fmt::format(
        "- rotation error of single images (deg, {}): median {:.3f}, 95 % {:.3f}, max {:.2f}, "
        "under "
        "5 in {:.1f} %; "
        "fronto-parallel ({} images): median {:.3f}, 95 % {:.3f}\n"
        "- covariance: error squared over covariance, of 3: mean {:.2f}, median {:.2f}, 95 % "
        "{:.1f}\n",
        world_axes ? "axes of the world" : "axes fitted to the sequence", Quantile(errors_deg, 0.5),
        Quantile(errors_deg, 0.95), Quantile(errors_deg, 1),
        100.0 *
            static_cast<double>(std::count_if(errors_deg.begin(), errors_deg.end(),
                                              [](double e) { return e < 5; })) /
            static_cast<double>(errors_deg.size()),
        frontal_deg.size(), Quantile(frontal_deg, 0.5), Quantile(frontal_deg, 0.95), Mean(nees),
        Quantile(nees, 0.5), Quantile(nees, 0.95));
  }
  // Over 1 s, both ends followed under the same names.
  std::vector<double> relative_deg;
  int flips = 0;
  for (size_t i = 0, j = 0; i < frames.size(); ++i) {
    while (j < frames.size() && frames[j].stamp_us < frames[i].stamp_us + 1'000'000) ++j;
    if (j == frames.size()) break;
    const Seen &a = frames[i], &b = frames[j];
    if (!a.followed || !b.followed || a.generation != b.generation) continue;
    if (!a.world_from_cam || !b.world_from_cam) continue;
    const Eigen::Quaterniond found = *b.followed * a.followed->conjugate();
    const Eigen::Quaterniond truth = b.world_from_cam->conjugate() * *a.world_from_cam;
    relative_deg.push_back(AngleBetween_rad(found, truth) * kDegPerRad);
    flips += relative_deg.back() > 45;
  }
  std::cout << fmt::format(
      "- relative rotation over 1 s from followed axes alone ({} pairs, deg): median {:.3f}, 95 % "
      "{:.3f}, max {:.2f}; flips of an axis {}\n",
      relative_deg.size(), Quantile(relative_deg, 0.5), Quantile(relative_deg, 0.95),
      Quantile(relative_deg, 1), flips);
  std::cout << fmt::format(
      "- wall time, median (ms): lines {:.2f}, descriptors {:.2f}, VPs {:.2f}\n\n",
      Quantile(ms[0], 0.5), Quantile(ms[1], 0.5), Quantile(ms[2], 0.5));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures vanishing points and followed axes on sequences with truth.");
  std::vector<std::string> sequences;
  SourceOptions source_options;
  std::string lines, method;
  bool world_axes = false;
  double turn_sigma_deg = 3;
  app.add_option("--data", sequences, "folders in TUM RGB-D layout, sim:room, sim:corridor")
      ->required();
  app.add_option("--frames", source_options.max_frames, "at most so many of each; 0: all");
  app.add_flag("--world-axes", world_axes,
               "the axes of the truth's world are the Manhattan axes; otherwise those that fit all "
               "images best");
  app.add_option("--turn-sigma", turn_sigma_deg,
                 "how much the camera may turn between images, deg: all that the follower is told")
      ->capture_default_str();
  app.add_option("--lines", lines, "line detector")
      ->check(CLI::IsMember({"lsd", "edlines", "fld"}));
  app.add_option("--vp", method, "how vanishing points are found")
      ->check(CLI::IsMember({"three_line", "two_line_grid", "two_line_grid_raw"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  cv::setNumThreads(1);
  try {
    DetectorOptions options;
    if (!lines.empty()) options.lines.detector.kind = *LineDetectorKindFromName(lines);
    if (!method.empty()) options.vps.method = *VpMethodFromName(method);
    for (const std::string& sequence : sequences) {
      const auto source = OpenSource(sequence, source_options);
      const Detector detector(source->camera(), options);
      AxisFollower follower{AxisFollowerOptions()};
      std::array<std::vector<double>, 3> ms;
      const std::vector<Seen> frames = Watch(*source, detector, follower, turn_sigma_deg, &ms);
      Report(sequence, frames, world_axes, ms);
    }
  } catch (const std::exception& e) {
    std::cerr << "vp_sequence_bench: " << e.what() << "\n";
    return 1;
  }
  return 0;
}
