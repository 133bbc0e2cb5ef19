// A trajectory of TartanAir [Wang, Zhu, Wang, Hu, Qiu, Wang, Hu, Kapoor, Scherer, IROS 2020], of
// which the left camera is played, as https://github.com/castacks/tartanair_tools (data_type.md)
// describes it; version 2 has other names:
//   image_left/000000_left.png, or image_lcam_front/000000_lcam_front.png
//   pose_left.txt, or pose_lcam_front.txt    a line for each image, `tx ty tz qx qy qz qw`, m
// Poses are camera-to-world in axes north, east, down, where the camera's are x forward, y right,
// z down. The camera's here are x right, y down, z forward, so
//   world_from_cam = pose * ned_from_cam,   ned_from_cam = [0 0 1; 1 0 0; 0 1 0].
// The calibration is the published one: 90 degrees, f = cx = half the width. No file has times:
// --fps, or 10 Hz.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

bool IsTartanAirFolder(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenTartanAirFolder(const std::string& path,
                                                 const SourceOptions& options);

}  // namespace vpslam
