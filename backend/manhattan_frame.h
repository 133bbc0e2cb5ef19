// The Manhattan frame of a map: three orthogonal directions of the world that vanishing points
// show.
//
// It is born when several keyframes in a row agree about it, is the mean of what all keyframes of
// the map say (never frozen at what the first one said, as the paper's section III-B does), and is
// forgotten when the scene does not bear it out. Bundle adjustment holds keyframes to it.
#pragma once

#include <map>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "backend/mapper_options.h"
#include "core/features/line_set.h"
#include "core/map/map.h"

namespace vpslam {

/// What a keyframe's vanishing points say, under the names that the map's frame gives the axes.
struct ManhattanMeasurement {
  Eigen::Quaterniond cam_from_manhattan = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Identity();  ///< of the left perturbation
};

class ManhattanFrame {
 public:
  explicit ManhattanFrame(const ManhattanOptions& options);

  /// Takes up what the lines of a keyframe say, if it is worth anything.
  void Add(KeyframeId keyframe, const LineSet& lines);
  /// Lets the axes that a new keyframe shows bind it in its first adjustment already, if they fit
  /// the pose that it comes with.
  void Expect(const Keyframe& keyframe);
  /// Names, birth, mean and loss, with the keyframes of `map` where they are now.
  void Update(const Map& map);
  void Clear();
  /// Takes up what `other` knows, whose map has become part of this one's. This frame stays, if
  /// there is one.
  void Absorb(const ManhattanFrame& other, const Eigen::Quaterniond& world_from_other_world);

  /// Set while the frame exists.
  const std::optional<Eigen::Quaterniond>& world_from_manhattan() const { return frame_; }
  /// By how much the keyframes of `other`, brought over into this one's world, have to be turned
  /// there for their axes to be those of this frame; nullopt where they do not agree about it.
  std::optional<Eigen::Quaterniond> TurnOf(const ManhattanFrame& other,
                                           const Eigen::Quaterniond& world_from_other_world,
                                           const Map& map) const;
  /// Whether a turn is more than a keyframe may be corrected by.
  bool Contradicts(const Eigen::Quaterniond& turn) const;
  /// What binds this keyframe, if anything does; its covariance holds what the map has found
  /// detectors to err beyond what they say.
  std::optional<ManhattanMeasurement> Find(KeyframeId keyframe) const;

 private:
  struct Entry {
    ManhattanMeasurement measurement;  ///< as reported
    double innovation_rad = 0;
    bool fits = false;   ///< belongs to the frame
    bool binds = false;  ///< ... or may, once adjustment has undone what turned its keyframe
  };

  void TryBirth(const Map& map);
  /// Names, `fits` and `binds`. Returns where the keyframe sees the frame.
  Eigen::Quaterniond Judge(const Keyframe& keyframe, Entry* entry) const;
  void Fit(const Map& map);
  /// From how far measurements lie from the frame: half of them within what is to be expected.
  void LearnExtraSigma();
  ManhattanMeasurement WithExtra(ManhattanMeasurement measurement) const;

  ManhattanOptions options_;
  std::map<KeyframeId, Entry> entries_;
  std::optional<Eigen::Quaterniond> frame_;
  double extra_sigma_rad_;  ///< about any direction, beyond what detectors say
};

}  // namespace vpslam
