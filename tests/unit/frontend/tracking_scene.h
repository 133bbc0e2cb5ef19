// A scene with a map of it, and frames that look at it: what the stages of tracking work on.
#pragma once

#include <map>
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
    frame.seq = seq;
    frame.features = view.features;
    frame.grid = view.grid;
    frame.points.resize(frame.features.size());
    views_[seq] = std::move(view);
    return frame;
  }
  /// With its true pose, and all matches that there are.
  Frame TrackedFrame(const SE3& pose, int64_t seq, KeyframeId reference = KeyframeId(0)) {
    Frame frame = NewFrame(pose, seq);
    std::map<int, PointId> id_of;
    for (const auto& [id, p] : map.truth) id_of[p] = id;
    for (int f = 0; f < frame.features.size(); ++f) {
      const auto at = id_of.find(views_[seq].point[f]);
      if (at != id_of.end() && map.map.Find(at->second)) frame.points[f] = at->second;
    }
    frame.cam_from_world = pose;
    frame.reference = reference;
    frame.cam_from_reference = pose * map.map.Find(reference)->cam_from_world.Inverse();
    frame.inliers = frame.matches = NumMatched(frame);
    return frame;
  }

  /// The point of the scene that the feature shows; -1 for none.
  int PointOf(const Frame& frame, int feature) const { return views_.at(frame.seq).point[feature]; }
  int FeatureOf(const Frame& frame, int p) const { return views_.at(frame.seq).FeatureOf(p); }
  SE3 TruthOf(const Frame& frame) const { return views_.at(frame.seq).cam_from_world; }

  static int NumMatched(const Frame& frame) {
    return static_cast<int>(std::count_if(frame.points.begin(), frame.points.end(),
                                          [](PointId id) { return id.IsValid(); }));
  }
  int NumWrong(const Frame& frame) const {
    int wrong = 0;
    for (int f = 0; f < frame.features.size(); ++f) {
      if (frame.points[f].IsValid()) wrong += map.truth.at(frame.points[f]) != PointOf(frame, f);
    }
    return wrong;
  }
  double PositionError(const Frame& frame) const {
    return (frame.cam_from_world.Center() - TruthOf(frame).Center()).norm();
  }

 private:
  std::map<int64_t, SyntheticView> views_;
};

}  // namespace vpslam
