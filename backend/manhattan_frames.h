// The Manhattan frames of a map: each is three orthogonal directions of the world that vanishing
// points show. Most places have one; a wing that stands at an angle to the rest has its own.
//
// A frame is born when several keyframes in a row agree about it and no frame explains them. It is
// the mean of what all keyframes that belong to it say (never frozen at what the first one said, as
// the paper's section III-B does). It is forgotten when, still young, the scene does not bear it
// out. Bundle adjustment holds keyframes to the frame that they belong to, and to no other.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "backend/mapper_options.h"
#include "core/features/line_set.h"
#include "core/map/owned_map.h"

namespace vpslam {

/// What a keyframe's vanishing points say, under the names that its frame gives the axes.
struct ManhattanMeasurement {
  Eigen::Quaterniond cam_from_manhattan = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Identity();  ///< of the left perturbation
};

/// What binds a keyframe.
struct ManhattanBinding {
  ManhattanMeasurement measurement;
  Eigen::Quaterniond world_from_manhattan = Eigen::Quaterniond::Identity();
};

class ManhattanFrames {
 public:
  explicit ManhattanFrames(const ManhattanOptions& options) : options_(options) {}

  /// Takes up what the lines of a keyframe say, if it is worth anything.
  void Add(KeyframeId keyframe, const LineSet& lines);
  /// Lets the axes that a new keyframe shows bind it in its first adjustment already, if they fit
  /// the pose that it comes with. Returns the frame that does; invalid for none.
  ManhattanId Expect(const Keyframe& keyframe);
  /// Names, birth, mean and loss, with the keyframes of `map_id` where they are now. What has come
  /// of it goes into the map: frames, and to which of them each keyframe belongs.
  void Update(MapId map_id, OwnedMap* map);
  /// Takes up what `other` knows, whose map has become part of this one's. Of two frames that are
  /// the same, this one's stays, and the other is erased in the map.
  void Absorb(const ManhattanFrames& other, const Eigen::Quaterniond& world_from_other_world,
              OwnedMap* map);

  /// The frame's axes in world, as they are now.
  std::vector<Eigen::Quaterniond> worlds_from_manhattan() const;
  /// By how much the keyframes of `other`, brought over into this one's world, have to be turned
  /// there for their axes to be those of a frame of this one; nullopt where most of them do not
  /// agree about one.
  std::optional<Eigen::Quaterniond> TurnOf(const ManhattanFrames& other,
                                           const Eigen::Quaterniond& world_from_other_world,
                                           const Map& map) const;
  /// Whether a turn is more than a keyframe may be corrected by.
  bool Contradicts(const Eigen::Quaterniond& turn) const;
  /// What binds this keyframe, if anything does; its covariance holds what the map has found
  /// detectors to err beyond what they say.
  std::optional<ManhattanBinding> Find(KeyframeId keyframe) const;

 private:
  struct Frame {
    ManhattanId id;  ///< in the map; invalid until it is there
    Eigen::Quaterniond world_from_manhattan;
    double extra_sigma_rad;  ///< about any direction, beyond what detectors say
  };
  struct Entry {
    ManhattanMeasurement measurement;
    int frame = -1;  ///< the nearest, an index into frames_; -1 while there is none
    double innovation_rad = 0;
    bool fits = false;   ///< belongs to that frame
    bool binds = false;  ///< ... or may, once adjustment has undone what turned its keyframe
  };

  void TryBirth(const Map& map);
  /// Nearest frame, names, `fits` and `binds`.
  void Judge(const Keyframe& keyframe, Entry* entry) const;
  /// Means, and what they leave unexplained.
  void Fit(const Map& map);
  void ForgetUnconfirmed(OwnedMap* map);
  void Forget(int frame, OwnedMap* map);
  /// From how far measurements lie from the frame: half of them within what is to be expected.
  void LearnExtraSigma(int frame);
  void WriteInto(MapId map_id, OwnedMap* map);
  ManhattanMeasurement WithExtra(const Entry& entry) const;

  ManhattanOptions options_;
  std::map<KeyframeId, Entry> entries_;
  std::vector<Frame> frames_;
};

}  // namespace vpslam
