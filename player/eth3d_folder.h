// A sequence of the ETH3D SLAM benchmark [Schöps, Sattler, Pollefeys, CVPR 2019],
// https://www.eth3d.net/slam_documentation: the layout of TUM RGB-D, of undistorted colour images,
// with a calibration:
//   calibration.txt    one line `fx fy cx cy`, px
//   rgb.txt            lines `seconds rgb/file.png`, about 27 Hz
//   groundtruth.txt    of the training sequences: lines `seconds tx ty tz qx qy qz qw`, m
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

/// True where there is a calibration of that kind, and no camera.yaml.
bool IsEth3dFolder(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenEth3dFolder(const std::string& path, const SourceOptions& options);

}  // namespace vpslam
