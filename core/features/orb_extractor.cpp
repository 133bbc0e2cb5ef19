#include "core/features/orb_extractor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/features/corner_detector.h"
#include "core/features/corner_refinement.h"
#include "core/features/edge_shape.h"
#include "core/features/image_pyramid.h"
#include "core/features/keypoint_distribution.h"
#include "core/features/orb_descriptor.h"
#include "core/features/orientation.h"
#include "core/geometry/image_mask.h"

namespace vpslam {
namespace {

/// Key points keep this distance from the border of their level: the discs for orientation and
/// descriptor must lie inside, the latter after rounding.
constexpr int kMargin_px = std::max(kOrientationRadius_px + 1, kDescriptorMargin_px);

/// Adds the time it lives to a sum of ms.
class Stopwatch {
 public:
  explicit Stopwatch(double* sum_ms) : sum_ms_(sum_ms), begin_(Clock::now()) {}
  ~Stopwatch() {
    *sum_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - begin_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double* sum_ms_;
  Clock::time_point begin_;
};

Camera Validated(const Camera& camera) {
  if (const auto why = camera.Validate()) throw std::invalid_argument("camera: " + *why);
  return camera;
}

OrbOptions Validated(const OrbOptions& options) {
  if (const auto why = options.Validate()) throw std::invalid_argument("ORB: " + *why);
  return options;
}

}  // namespace

std::optional<std::string> OrbOptions::Validate() const {
  if (num_features < 1 || num_features > 100000) return "num_features must lie in 1 to 100000";
  if (num_levels < 1 || num_levels > 32) return "num_levels must lie in 1 to 32";
  if (!(scale_factor > 1.01 && scale_factor <= 4)) return "scale_factor must lie in 1.01 to 4";
  if (fast_threshold < 1 || fast_threshold > 254) return "fast_threshold must lie in 1 to 254";
  if (fast_threshold_low < 1 || fast_threshold_low > fast_threshold) {
    return "fast_threshold_low must lie in 1 to fast_threshold";
  }
  if (cell_px < 8 || cell_px > 1024) return "cell_px must lie in 8 to 1024";
  return distribution.Validate();
}

class OrbExtractor::Impl {
 public:
  Impl(const Camera& camera, const OrbOptions& options)
      : camera_(Validated(camera)),
        options_(Validated(options)),
        bounds_(camera_.UndistortedBounds()),
        mask_(camera_.mask_runs, camera_.width, camera_.height),
        scales_(options_.num_levels, options_.scale_factor, options_.sigma_px),
        pyramid_(camera_.width, camera_.height, scales_, 2 * kMargin_px + 1),
        detector_({.threshold = options_.fast_threshold,
                   .threshold_low = options_.fast_threshold_low,
                   .cell_px = options_.cell_px,
                   .margin_px = kMargin_px}),
        distribution_(options_.distribution),
        corners_(pyramid_.num_levels()) {}

  Features Extract(const cv::Mat& image) {
    if (image.type() != CV_8UC1 || image.cols != camera_.width || image.rows != camera_.height) {
      throw std::invalid_argument("ORB needs a grey 8-bit image of the camera's size");
    }
    timings_ = {};
    {
      const Stopwatch watch(&timings_.pyramid_ms);
      pyramid_.Build(image);
    }
    std::vector<int> available;
    {
      const Stopwatch watch(&timings_.detection_ms);
      for (int octave = 0; octave < pyramid_.num_levels(); ++octave) {
        detector_.Detect(pyramid_.level(octave), &corners_[octave]);
        if (mask_.HidesAnything()) LeaveOutHidden(octave);
        available.push_back(static_cast<int>(corners_[octave].size()));
      }
    }
    {
      const Stopwatch watch(&timings_.distribution_ms);
      const std::vector<int> shares =
          ShareOut(options_.num_features, options_.scale_factor, available);
      for (int octave = 0; octave < pyramid_.num_levels(); ++octave) {
        distribution_.Select(pyramid_.level(octave).size(), shares[octave], &corners_[octave]);
      }
    }
    Features features;
    features.keypoints.reserve(options_.num_features);
    features.descriptors.reserve(options_.num_features);
    for (int octave = 0; octave < pyramid_.num_levels(); ++octave) AppendLevel(octave, &features);
    return features;
  }

  const ScalePyramid& scales() const { return scales_; }
  const OrbTimings& timings() const { return timings_; }

 private:
  /// Before corners are chosen, so that others come in their place.
  void LeaveOutHidden(int octave) {
    std::erase_if(corners_[octave], [&](const Corner& c) {
      return mask_.Hides({pyramid_.ToLevelZeroX(octave, static_cast<float>(c.x)),
                          pyramid_.ToLevelZeroY(octave, static_cast<float>(c.y))});
    });
  }

  void AppendLevel(int octave, Features* features) {
    const cv::Mat& level = pyramid_.level(octave);
    std::vector<Corner>& corners = corners_[octave];
    std::vector<Keypoint> keypoints;
    {
      const Stopwatch watch(&timings_.position_ms);
      std::erase_if(corners, [&](const Corner& c) {
        const auto [dx, dy] = SubpixelOffset(level, c.x, c.y);
        const auto position =
            camera_.Undistort({pyramid_.ToLevelZeroX(octave, static_cast<float>(c.x) + dx),
                               pyramid_.ToLevelZeroY(octave, static_cast<float>(c.y) + dy)});
        if (!position || !bounds_.Contains(*position)) return true;
        keypoints.push_back({.x_px = static_cast<float>(position->x()),
                             .y_px = static_cast<float>(position->y()),
                             .response = static_cast<float>(c.score),
                             .octave = octave});
        SetEdgeShape(EdgeShapeAt(level, c.x, c.y), c, &keypoints.back());
        return false;
      });
    }
    angles_rad_.resize(corners.size());
    {
      const Stopwatch watch(&timings_.orientation_ms);
      for (size_t i = 0; i < corners.size(); ++i) {
        angles_rad_[i] = Orientation_rad(level, corners[i].x, corners[i].y);
        keypoints[i].angle_rad = angles_rad_[i];
      }
    }
    const Stopwatch watch(&timings_.description_ms);
    const std::vector<Descriptor> descriptors = Describe(level, corners, angles_rad_);
    features->descriptors.insert(features->descriptors.end(), descriptors.begin(),
                                 descriptors.end());
    features->keypoints.insert(features->keypoints.end(), keypoints.begin(), keypoints.end());
  }

  void SetEdgeShape(const EdgeShape& shape, const Corner& corner, Keypoint* keypoint) const {
    keypoint->roundness_per_10000 = static_cast<int16_t>(std::lround(1e4f * shape.roundness));
    double edge_rad = shape.edge_rad;
    if (camera_.HasDistortion()) {  // as it lies in the undistorted image
      const double x = pyramid_.ToLevelZeroX(keypoint->octave, static_cast<float>(corner.x));
      const double y = pyramid_.ToLevelZeroY(keypoint->octave, static_cast<float>(corner.y));
      const double dx = std::cos(edge_rad), dy = std::sin(edge_rad);
      const auto from = camera_.Undistort({x - dx, y - dy});
      const auto to = camera_.Undistort({x + dx, y + dy});
      if (from && to) edge_rad = std::atan2(to->y() - from->y(), to->x() - from->x());
      if (edge_rad < 0) edge_rad += std::numbers::pi;
    }
    keypoint->edge_mrad = static_cast<int16_t>(std::lround(1e3 * edge_rad) % 3142);
  }

  Camera camera_;
  OrbOptions options_;
  Camera::Bounds bounds_;
  ImageMask mask_;
  ScalePyramid scales_;
  ImagePyramid pyramid_;
  CornerDetector detector_;
  KeypointDistribution distribution_;
  std::vector<std::vector<Corner>> corners_;  ///< per level
  std::vector<float> angles_rad_;
  OrbTimings timings_;
};

OrbExtractor::OrbExtractor(const Camera& camera, const OrbOptions& options)
    : impl_(std::make_unique<Impl>(camera, options)) {}
OrbExtractor::~OrbExtractor() = default;
OrbExtractor::OrbExtractor(OrbExtractor&&) noexcept = default;
OrbExtractor& OrbExtractor::operator=(OrbExtractor&&) noexcept = default;

Features OrbExtractor::Extract(const cv::Mat& image) { return impl_->Extract(image); }
const ScalePyramid& OrbExtractor::scales() const { return impl_->scales(); }
const OrbTimings& OrbExtractor::last_timings() const { return impl_->timings(); }

}  // namespace vpslam
