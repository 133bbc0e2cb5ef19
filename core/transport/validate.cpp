#include "core/transport/validate.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace vpslam {
namespace {

constexpr double kMaxLength = 1e12;  // map units
constexpr double kMaxCommandValue = 1e9;
constexpr double kMaxPixel = 1e6;        // undistorted pixels may lie far outside the image
constexpr double kUnitTolerance = 1e-3;  // of norms
constexpr int kMaxOctave = 32;
// Ids are indices of what grows to hold them.
constexpr int32_t kMaxId = 1 << 24;
constexpr int64_t kMaxSeq = int64_t{1} << 61;  // sums of some have to fit, too

bool IsNameCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.';
}

// Remembers the first fault.
class Checker {
 public:
  void Require(bool ok, std::string_view what) {
    if (!ok && !fault_) fault_ = std::string(what);
  }
  void Require(bool ok, std::string_view list, std::size_t index, std::string_view what) {
    if (!ok && !fault_) fault_ = fmt::format("{} {}: {}", list, index, what);
  }
  void Add(const Fault& fault) {
    if (fault && !fault_) fault_ = fault;
  }
  const Fault& fault() const { return fault_; }

 private:
  Fault fault_;
};

bool InRange(double value, double limit) { return std::abs(value) <= limit; }  // false for NaN
bool IsId(int32_t id) { return id >= 0 && id <= kMaxId; }
bool IsIdOrNone(int32_t id) { return id == -1 || IsId(id); }

template <class Vector>
bool AllInRange(const Vector& v, double limit) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= limit;
}

bool IsUnit(const Eigen::Quaterniond& q) {
  return q.coeffs().allFinite() && std::abs(q.norm() - 1) <= kUnitTolerance;
}

bool IsPose(const SE3& pose) {
  return IsUnit(pose.rotation) && AllInRange(pose.translation, kMaxLength);
}

bool IsText(const std::string& text) {
  return text.size() <= kMaxTextLength && text.find('\0') == std::string::npos;
}

// A duration that may be unknown. Slightly negative ones come from rounding.
bool IsDurationOrNotRun(double ms) { return std::isnan(ms) || (ms > -1 && ms < 1e9); }

Fault ValidateFeatures(const Features& features) {
  Checker check;
  check.Require(features.keypoints.size() == features.descriptors.size(),
                "numbers of keypoints and descriptors differ");
  check.Require(features.keypoints.size() <= kMaxFeatures, "too many features");
  for (std::size_t i = 0; i < features.keypoints.size() && !check.fault(); ++i) {
    const Keypoint& k = features.keypoints[i];
    check.Require(InRange(k.x_px, kMaxPixel) && InRange(k.y_px, kMaxPixel), "keypoint", i,
                  "position out of range");
    check.Require(InRange(k.angle_rad, 10) && std::isfinite(k.response), "keypoint", i,
                  "angle or response out of range");
    check.Require(k.roundness_per_10000 >= 0 && k.roundness_per_10000 <= 10000, "keypoint", i,
                  "roundness out of range");
    check.Require(k.octave >= 0 && k.octave <= kMaxOctave, "keypoint", i, "octave out of range");
  }
  return check.fault();
}

Fault ValidateTimes(const TrackingTimes& t) {
  Checker check;
  for (const double ms :
       {t.decode_ms, t.transport_ms, t.features_ms, t.lines_ms, t.vps_ms, t.wait_for_lines_ms,
        t.initial_pose_ms, t.rotation_ms, t.translation_ms, t.local_map_ms, t.total_ms}) {
    check.Require(IsDurationOrNotRun(ms), "time of a stage out of range");
  }
  return check.fault();
}

Fault ValidateTimes(const MappingTimes& t) {
  Checker check;
  for (const double ms : {t.insertion_ms, t.feature_culling_ms, t.feature_creation_ms,
                          t.keyframe_culling_ms, t.local_ba_ms, t.total_ms}) {
    check.Require(IsDurationOrNotRun(ms), "time of a stage out of range");
  }
  return check.fault();
}

}  // namespace

bool IsProcessName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxNameLength &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

bool IsImageSegmentName(const std::string& name) {
  constexpr std::string_view kPrefix = "/vpslam-";
  return name.size() > kPrefix.size() && name.size() <= kMaxNameLength &&
         name.compare(0, kPrefix.size(), kPrefix) == 0 &&
         std::all_of(name.begin() + kPrefix.size(), name.end(), IsNameCharacter);
}

Fault Validate(const Header& header) {
  Checker check;
  check.Require(header.seq >= 0 && header.seq <= kMaxSeq, "sequence number out of range");
  check.Require(header.oldest_seq >= 0 && header.oldest_seq <= header.seq,
                "oldest sequence number out of range");
  return check.fault();
}

Fault Validate(const Camera& camera) {
  Checker check;
  check.Add(camera.Validate());
  check.Require(camera.width <= kMaxImageSide && camera.height <= kMaxImageSide,
                "image size out of range");
  return check.fault();
}

Fault Validate(const ImageMessage& image) {
  Checker check;
  check.Require(image.frame_seq >= 0, "negative frame number");
  check.Require(image.width > 0 && image.width <= kMaxImageSide, "width out of range");
  check.Require(image.height > 0 && image.height <= kMaxImageSide, "height out of range");
  check.Require(IsDurationOrNotRun(image.decode_ms), "decode time out of range");
  if (check.fault()) return check.fault();
  if (image.segment.empty()) {
    check.Require(image.bytes.size() == static_cast<std::size_t>(image.width) * image.height,
                  "number of bytes does not fit width x height");
  } else {
    check.Require(IsImageSegmentName(image.segment), "alien name of a shared memory segment");
    check.Require(image.bytes.empty(), "pixels both inline and in shared memory");
    check.Require(image.slot >= 0 && image.slot <= 65535, "slot out of range");
    check.Require(image.generation > 0 && image.generation % 2 == 0, "generation out of range");
  }
  return check.fault();
}

Fault Validate(const FrameFeatures& features) {
  Checker check;
  check.Require(features.frame_seq >= 0, "negative frame number");
  check.Require(IsDurationOrNotRun(features.decode_ms) && IsDurationOrNotRun(features.features_ms),
                "time of a stage out of range");
  check.Add(ValidateFeatures(features.features));
  if (features.lines) {
    if (const Fault fault = Validate(*features.lines)) check.Add("lines: " + *fault);
  }
  return check.fault();
}

Fault Validate(const LineSet& set) {
  Checker check;
  check.Require(set.frame_seq >= 0, "negative frame number");
  check.Require(set.lines.size() <= kMaxFeatures, "too many lines");
  check.Require(set.vanishing_points.size() <= kMaxFeatures, "too many vanishing points");
  check.Require(set.manhattan == ManhattanState::kNone || set.manhattan == ManhattanState::kTwo ||
                    set.manhattan == ManhattanState::kThree,
                "unknown Manhattan state");
  check.Require(set.manhattan == ManhattanState::kNone ||
                    set.vanishing_points.size() >= static_cast<std::size_t>(set.manhattan),
                "fewer vanishing points than Manhattan axes");
  check.Require(IsUnit(set.cam_from_manhattan), "Manhattan rotation is no unit quaternion");
  check.Require(set.covariance_rad2.allFinite(), "covariance not finite");
  check.Require(IsDurationOrNotRun(set.lines_ms) && IsDurationOrNotRun(set.descriptors_ms) &&
                    IsDurationOrNotRun(set.vps_ms),
                "time of a stage out of range");
  const auto num_vps = static_cast<int64_t>(set.vanishing_points.size());
  for (std::size_t i = 0; i < set.lines.size() && !check.fault(); ++i) {
    const LineSegment& line = set.lines[i];
    check.Require(AllInRange(line.start_px, kMaxPixel) && AllInRange(line.end_px, kMaxPixel),
                  "line", i, "end point out of range");
    check.Require(line.sigma_px >= 0 && line.sigma_px <= kMaxPixel, "line", i,
                  "sigma out of range");
    check.Require(line.label >= -1 && line.label < num_vps, "line", i, "label out of range");
  }
  for (std::size_t i = 0; i < set.vanishing_points.size() && !check.fault(); ++i) {
    const VanishingPoint& vp = set.vanishing_points[i];
    check.Require(vp.direction_in_cam.allFinite() &&
                      std::abs(vp.direction_in_cam.norm() - 1) <= kUnitTolerance,
                  "vanishing point", i, "direction is no unit vector");
    check.Require(vp.covariance_rad2.allFinite(), "vanishing point", i, "covariance not finite");
    check.Require(vp.support >= 0, "vanishing point", i, "negative support");
  }
  return check.fault();
}

Fault Validate(const LinesRequest& request) {
  Checker check;
  check.Require(request.frame_seq >= 0, "negative frame number");
  return check.fault();
}

Fault Validate(const FramePose& pose) {
  Checker check;
  check.Require(pose.frame_seq >= 0, "negative frame number");
  check.Require(pose.state == TrackingState::kInitialising ||
                    pose.state == TrackingState::kTracking || pose.state == TrackingState::kLost,
                "unknown tracking state");
  check.Require(IsIdOrNone(pose.map.value) && IsIdOrNone(pose.reference.value) &&
                    IsIdOrNone(pose.keyframe.value),
                "id out of range");
  check.Require(pose.state != TrackingState::kTracking ||
                    (IsId(pose.map.value) && IsId(pose.reference.value)),
                "a tracked pose needs a map and a reference keyframe");
  check.Require(IsPose(pose.cam_from_world), "cam_from_world is no pose");
  check.Require(IsPose(pose.cam_from_reference), "cam_from_reference is no pose");
  check.Require(pose.covariance.allFinite(), "covariance not finite");
  check.Require(pose.inliers >= 0 && pose.matches >= 0, "negative number of matches");
  check.Add(ValidateTimes(pose.times));
  return check.fault();
}

Fault Validate(const Truth& truth) {
  Checker check;
  check.Require(truth.frame_seq >= 0, "negative frame number");
  check.Require(IsPose(truth.world_from_cam), "world_from_cam is no pose");
  return check.fault();
}

Fault Validate(const KeyframeProposal& k) {
  Checker check;
  check.Require(IsId(k.id.value) && IsId(k.map.value), "a keyframe needs an id and a map");
  check.Require(k.role == KeyframeRole::kRegular || k.role == KeyframeRole::kMapFirst ||
                    k.role == KeyframeRole::kMapSecond,
                "unknown role");
  check.Require(IsIdOrNone(k.discarded_map.value) && IsIdOrNone(k.reference.value),
                "id out of range");
  check.Require(k.frame_seq >= 0, "negative frame number");
  check.Require(IsPose(k.cam_from_world), "cam_from_world is no pose");
  check.Add(ValidateFeatures(k.features));
  check.Require(k.points.size() == k.features.keypoints.size(),
                "numbers of features and of their map points differ");
  check.Require(std::all_of(k.points.begin(), k.points.end(),
                            [](PointId id) { return IsIdOrNone(id.value); }),
                "point id out of range");
  for (std::size_t i = 0; i < k.sightings.size() && !check.fault(); ++i) {
    const PointSighting& s = k.sightings[i];
    check.Require(IsId(s.point.value) && s.found >= 0 && s.visible >= 0, "sighting", i,
                  "out of range");
  }
  check.Require(k.role == KeyframeRole::kMapSecond || k.initial_points.empty(),
                "initial points without the role that they belong to");
  const auto num_features = static_cast<int64_t>(k.features.keypoints.size());
  for (std::size_t i = 0; i < k.initial_points.size() && !check.fault(); ++i) {
    const InitialPoint& p = k.initial_points[i];
    check.Require(p.feature_in_first >= 0 &&
                      p.feature_in_first < static_cast<int32_t>(kMaxFeatures) &&
                      p.feature_in_second >= 0 && p.feature_in_second < num_features,
                  "initial point", i, "feature index out of range");
    check.Require(AllInRange(p.position_in_world, kMaxLength), "initial point", i,
                  "position out of range");
  }
  if (const Fault fault = Validate(k.lines)) check.Add("lines: " + *fault);
  check.Require(k.map_lines.size() == k.lines.lines.size(),
                "numbers of lines and of their map lines differ");
  check.Require(std::all_of(k.map_lines.begin(), k.map_lines.end(),
                            [](LineId id) { return IsIdOrNone(id.value); }),
                "line id out of range");
  check.Require(IsIdOrNone(k.seam.map.value) && IsPose(k.seam.cam_from_world), "seam out of range");
  for (std::size_t i = 0; i < k.seam.points.size() && !check.fault(); ++i) {
    const auto& p = k.seam.points[i];
    check.Require(p.feature >= 0 && p.feature < num_features && IsId(p.landmark.value),
                  "seam point", i, "out of range");
  }
  return check.fault();
}

Fault Validate(const MapDelta& d) {
  Checker check;
  // Within a snapshot versions run downwards from 0.
  check.Require(d.version >= d.base_version || d.base_version <= 0, "versions out of order");
  check.Require(IsIdOrNone(d.answers.value), "id out of range");
  check.Add(ValidateTimes(d.times));
  check.Require(std::all_of(d.erased_maps.begin(), d.erased_maps.end(),
                            [](MapId id) { return IsId(id.value); }),
                "id of an erased map out of range");
  for (std::size_t i = 0; i < d.merged_maps.size() && !check.fault(); ++i) {
    const MapMerger& m = d.merged_maps[i];
    check.Require(IsId(m.from.value) && IsId(m.into.value) && m.from != m.into, "merger", i,
                  "id out of range");
  }
  for (std::size_t i = 0; i < d.keyframes.size() && !check.fault(); ++i) {
    const KeyframeState& k = d.keyframes[i];
    check.Require(IsId(k.id.value) && IsId(k.map.value) && IsIdOrNone(k.parent.value), "keyframe",
                  i, "id out of range");
    check.Require(k.frame_seq >= 0, "keyframe", i, "negative frame number");
    check.Require(IsPose(k.cam_from_world) && IsPose(k.cam_from_parent), "keyframe", i,
                  "pose out of range");
    check.Require(k.unit > 0 && k.unit <= kMaxLength, "keyframe", i, "unit out of range");
    const auto is_sound = [](const auto& o) {
      return o.feature >= 0 && o.feature < static_cast<int32_t>(kMaxFeatures) &&
             IsId(o.landmark.value);
    };
    check.Require(std::all_of(k.points.begin(), k.points.end(), is_sound) &&
                      std::all_of(k.lines.begin(), k.lines.end(), is_sound),
                  "keyframe", i, "observation out of range");
  }
  for (std::size_t i = 0; i < d.appearances.size() && !check.fault(); ++i) {
    const PointAppearance& a = d.appearances[i];
    check.Require(IsId(a.id.value) && IsId(a.map.value) && IsIdOrNone(a.reference.value),
                  "appearance", i, "id out of range");
  }
  for (std::size_t i = 0; i < d.geometries.size() && !check.fault(); ++i) {
    const PointGeometry& g = d.geometries[i];
    check.Require(IsId(g.id.value), "geometry", i, "id out of range");
    check.Require(AllInRange(g.position, kMaxLength), "geometry", i, "position out of range");
    check.Require(AllInRange(g.normal, 1 + kUnitTolerance), "geometry", i, "normal out of range");
    check.Require(g.max_distance >= 0 && g.max_distance <= kMaxLength, "geometry", i,
                  "distance out of range");
  }
  for (std::size_t i = 0; i < d.lines.size() && !check.fault(); ++i) {
    const LineState& l = d.lines[i];
    check.Require(IsId(l.id.value) && IsId(l.map.value) && IsIdOrNone(l.reference.value), "line", i,
                  "id out of range");
    check.Require(AllInRange(l.start, kMaxLength) && AllInRange(l.end, kMaxLength), "line", i,
                  "end point out of range");
    check.Require(l.axis >= -1 && l.axis < 3, "line", i, "axis out of range");
  }
  const auto check_tombstones = [&check](const auto& tombstones) {
    for (std::size_t i = 0; i < tombstones.size() && !check.fault(); ++i) {
      const auto& t = tombstones[i];
      check.Require(IsId(t.id.value) && IsIdOrNone(t.replacement.value) && t.replacement != t.id,
                    "tombstone", i, "id out of range");
    }
  };
  check_tombstones(d.tombstones);
  check_tombstones(d.line_tombstones);
  for (std::size_t i = 0; i < d.manhattan_frames.size() && !check.fault(); ++i) {
    const MapManhattan& m = d.manhattan_frames[i];
    check.Require(IsId(m.map.value), "Manhattan frame", i, "id out of range");
    check.Require(!m.world_from_manhattan || IsUnit(*m.world_from_manhattan), "Manhattan frame", i,
                  "rotation is no unit quaternion");
  }
  return check.fault();
}

Fault Validate(const MapRequest& request) {
  Checker check;
  check.Require(IsProcessName(request.process), "alien process name");
  check.Require(request.map_version >= 0, "negative version");
  return check.fault();
}

Fault Validate(const Ack& ack) {
  Checker check;
  check.Require(IsProcessName(ack.stream) && IsProcessName(ack.consumer),
                "alien channel or process name");
  check.Require(ack.received >= -1 && ack.done >= -1 && ack.done <= ack.received,
                "sequence numbers out of range");
  return check.fault();
}

Fault Validate(const Command& command) {
  Checker check;
  check.Require(command.target.empty() || IsProcessName(command.target), "alien process name");
  const auto action = static_cast<int32_t>(command.action);
  check.Require(command.action == CommandAction::kStop ||
                    (action >= static_cast<int32_t>(CommandAction::kSaveNow) &&
                     action <= static_cast<int32_t>(CommandAction::kShow)),
                "unknown action");
  check.Require(command.value >= 0 && command.value <= kMaxCommandValue, "value out of range");
  return check.fault();
}

Fault Validate(const RunDescription& run) {
  Checker check;
  check.Require(IsText(run.commit), "commit too long or with a zero byte");
  check.Require(
      run.options.size() <= kMaxOptionsLength && run.options.find('\0') == std::string::npos,
      "options too long or with a zero byte");
  return check.fault();
}

Fault Validate(const ProcessStatus& s) {
  Checker check;
  check.Require(IsProcessName(s.process), "alien process name");
  const auto state = static_cast<int32_t>(s.state);
  check.Require(state >= static_cast<int32_t>(ProcessState::kStarting) &&
                    state <= static_cast<int32_t>(ProcessState::kFailed),
                "unknown state");
  check.Require(s.pid >= 0, "negative process id");
  check.Require(s.rate_hz >= 0 && s.rate_hz < 1e9 && s.cpu_s >= 0 && s.cpu_s < 1e12 &&
                    s.rss_peak_mb >= 0 && s.rss_peak_mb < 1e12,
                "rate or resources out of range");
  check.Require(s.processed >= 0 && s.queued >= 0 && s.dropped >= 0 && s.gaps >= 0 &&
                    s.rejected >= 0 && s.resent >= 0,
                "negative counter");
  check.Require(IsText(s.message), "message too long or with a zero byte");
  return check.fault();
}

Fault Validate(const Preview& preview) {
  Checker check;
  check.Require(preview.frame_seq >= 0, "negative frame number");
  check.Require(!preview.jpeg.empty() && preview.jpeg.size() <= Preview::kMaxBytes,
                "size of the picture out of range");
  return check.fault();
}

}  // namespace vpslam
