#include "frontend/placement.h"

namespace vpslam {

bool Placement::Match(int feature, const MapPoint& point) {
  if (point.map != map_) return false;
  points_[feature] = point.id;
  return true;
}

bool Placement::Match(int segment, const MapLine& line) {
  if (line.map != map_) return false;
  lines_[segment] = line.id;
  return true;
}

bool Placement::HangOn(const Map& map, KeyframeId keyframe) {
  reference = keyframe;
  if (!map.Hang(keyframe, cam_from_world, &cam_from_reference)) return false;
  unit = map.FindEvenCulled(keyframe)->unit;
  return true;
}

void Placement::BecomeKeyframe(KeyframeId id) {
  reference = id;
  cam_from_reference = SE3();
  unit = 1;
}

bool Placement::Follow(const Map& map, const FrameObservation& seen, SE3* velocity) {
  map_ = map.Resolve(map_);
  if (!map.Place(reference, cam_from_reference, &cam_from_world)) return false;
  const KeyframeNode& node = *map.FindEvenCulled(reference);
  if (velocity) velocity->translation *= node.unit / unit;
  unit = node.unit;
  const Keyframe* keyframe = map.Find(reference);
  if (keyframe && keyframe->frame_seq == seen.frame_seq) {
    points_ = keyframe->points;
    points_.resize(seen.num_features());
    lines_ = keyframe->lines;
    lines_.resize(seen.num_segments());
  }
  return true;
}

}  // namespace vpslam
