// A scene with a map of it, and frames that look at it: what the stages of tracking work on.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {

/// Keyframes 0 to n - 1 stand `spacing` apart on the x axis and know every point that two of them
/// show.
class TrackingScene {
 public:
  TrackingScene(uint64_t seed, const SyntheticOptions& options, int num_keyframes = 3,
                double spacing = 0.3)
      : scene(seed, options), map(scene) {
    for (int i = 0; i < num_keyframes; ++i) {
      map.AddKeyframe(scene.Look(PoseAt({spacing * i, 0, 0})));
    }
    map.AddPoints(0, static_cast<int>(scene.points.size()));
  }

  SyntheticScene scene;
  SyntheticMap map;

  TrackingContext context() const { return {scene.camera, scene.bounds, scene.scales, map.map}; }

  /// Nothing is known of it. Its true pose is kept here.
  Frame NewFrame(const SE3& pose, int64_t seq) {
    SyntheticView view = scene.Look(pose);
    Frame frame;
    frame.seen = FrameObservation::Make(seq, 0, view.features, scene.bounds);
    views_[seq] = std::move(view);
    return frame;
  }
  /// The frame shows these features instead of its own; of its matches, those stay whose features
  /// are still there.
  void SetFeatures(const Features& features, Frame* frame) const {
    const Placement before = frame->placement;
    frame->seen =
        FrameObservation::Make(frame->seq(), frame->seen->stamp_us, features, scene.bounds);
    frame->PlaceIn(before.map(), before.cam_from_world);
    for (int f = 0; f < std::min<int>(features.size(), before.points().size()); ++f) {
      if (before.points()[f].IsValid()) frame->placement.Match(f, Point(before.points()[f]));
    }
  }
  static void SetStamp(int64_t stamp_us, Frame* frame) {
    auto seen = std::make_shared<FrameObservation>(*frame->seen);
    seen->stamp_us = stamp_us;
    frame->seen = std::move(seen);
  }
  const MapPoint& Point(PointId id) const { return *map.map.Find(id); }
  /// With its true pose, and all matches that there are.
  Frame TrackedFrame(const SE3& pose, int64_t seq, KeyframeId reference = KeyframeId(0)) {
    Frame frame = NewFrame(pose, seq);
    frame.PlaceIn(map.map.Find(reference)->map, pose);
    MatchAll(&frame);
    Placement& placement = frame.placement;
    placement.reference = reference;
    placement.cam_from_reference = pose * map.map.Find(reference)->cam_from_world.Inverse();
    placement.inliers = placement.num_matches = NumMatched(frame);
    return frame;
  }
  /// With all points of the frame's map that it shows.
  void MatchAll(Frame* frame) const {
    for (const auto& [id, p] : map.truth) {
      const int f = FeatureOf(*frame, p);
      const MapPoint* point = map.map.Find(id);
      if (f >= 0 && point) frame->placement.Match(f, *point);
    }
  }

  /// The point of the scene that the feature shows; -1 for none.
  int PointOf(const Frame& frame, int feature) const {
    return views_.at(frame.seq()).point[feature];
  }
  int FeatureOf(const Frame& frame, int p) const { return views_.at(frame.seq()).FeatureOf(p); }
  SE3 TruthOf(const Frame& frame) const { return views_.at(frame.seq()).cam_from_world; }

  static int NumMatched(const Frame& frame) {
    const std::vector<PointId>& points = frame.placement.points();
    return static_cast<int>(
        std::count_if(points.begin(), points.end(), [](PointId id) { return id.IsValid(); }));
  }
  int NumWrong(const Frame& frame) const {
    int wrong = 0;
    const std::vector<PointId>& points = frame.placement.points();
    for (int f = 0; f < static_cast<int>(points.size()); ++f) {
      if (points[f].IsValid()) wrong += map.truth.at(points[f]) != PointOf(frame, f);
    }
    return wrong;
  }
  double PositionError(const Frame& frame) const {
    return (frame.placement.cam_from_world.Center() - TruthOf(frame).Center()).norm();
  }

 private:
  std::map<int64_t, SyntheticView> views_;
};

}  // namespace vpslam
