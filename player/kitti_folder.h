// A sequence of the KITTI odometry benchmark [Geiger, Lenz, Urtasun, CVPR 2012], of which the left
// camera is played, grey (image_0), or colour where that alone is there (image_2):
//   times.txt              a line `seconds` per image
//   image_0/000000.png ... by number
//   calib.txt              lines `P0: ` and 12 numbers, the 3 x 4 projection matrix of camera 0 by
//                          rows, px; the images are rectified
//   poses.txt, or ../../poses/NN.txt for the folder sequences/NN   optional: a line of 12 numbers
//                          per image, [R t] by rows, camera 0 in the world, m
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

bool IsKittiFolder(const std::string& path);

/// Truth is that of the camera that is played. Throws std::runtime_error with one line naming file,
/// fault and remedy.
std::unique_ptr<ImageSource> OpenKittiFolder(const std::string& path, const SourceOptions& options);

}  // namespace vpslam
