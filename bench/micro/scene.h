// What the micro-benchmarks work on: simulated images, and a made-up map with exact structure.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "core/estimation/pose_optimizer.h"
#include "core/geometry/camera.h"
#include "core/map/owned_map.h"

namespace vpslam {

struct SimulatedImages {
  Camera camera;
  std::vector<cv::Mat> images;
  std::vector<SE3> cam_from_world;
};

/// Some frames of sim:room, a sixth of a second apart; rendered once.
const SimulatedImages& Images();

struct MapScene {
  Camera camera;
  Camera::Bounds bounds;
  OwnedMap map;
  KeyframeId last;
};

/// `num_keyframes` views from a camera that moves sideways by 5 cm, some 300 points in each,
/// and some 50 upright lines if asked for, corners and ends of segments with 1 px of noise, poses,
/// points and lines off by 1 cm; the same for the same number.
MapScene MakeMapScene(int num_keyframes, bool with_lines = false);

/// `count` exact points and their projections with 1 px of noise into a camera at the origin; with
/// lines the like of these, and a measured rotation.
PoseMeasurements MakeMeasurements(const Camera& camera, int count, int num_lines = 0);

Camera SceneCamera();

}  // namespace vpslam
