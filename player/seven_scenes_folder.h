// A sequence of 7-Scenes [Shotton, Glocker, Zach, Izadi, Criminisi, Fitzgibbon, CVPR 2013] as it is
// published, of which the colour images are played:
//   frame-000000.color.png   640 x 480, 30 Hz
//   frame-000000.depth.png   left alone
//   frame-000000.pose.txt    4 x 4 camera-to-world, m, of the depth camera, from KinectFusion
// The colour camera is not calibrated in the data set: camera.yaml in the folder, or --camera.
// Truth is the depth camera's, some 2.5 cm beside.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

bool IsSevenScenesFolder(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenSevenScenesFolder(const std::string& path,
                                                   const SourceOptions& options);

}  // namespace vpslam
