// A sequence of ICL-NUIM [Handa, Whelan, McDonald, Davison, ICRA 2014] in its "TUM RGB-D
// compatible" form:
//   rgb/0.png ...       by number, 30 Hz
//   associations.txt    optional: lines `number depth/0.png number rgb/0.png`
//   *.gt.freiburg       lines `number tx ty tz qx qy qz qw`, m, for each image but the first ones
// The published calibration, fx 481.20, fy -480.00, cx 319.50, cy 239.50, has a negative fy because
// the axes of camera and world are x right, y up, z forward, which is a left-handed frame. Images
// are stored from top to bottom like all others. So they are played with fy = +480, and the truth
// is reflected in y: with D = diag(1, -1, 1),  R' = D R D,  t' = D t.
#pragma once

#include <memory>
#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "player/image_source.h"

namespace vpslam {

bool IsIclFolder(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenIclFolder(const std::string& path, const SourceOptions& options);

/// The published calibration, as above; config/cameras/icl_nuim.yaml has the same.
Camera IclCamera();

/// A pose in frames with y up as the same in frames with y down, and back.
SE3 ReflectY(const SE3& pose);

}  // namespace vpslam
