// The ASL folder layout of the EuRoC MAV data sets [Burri, Nikolic, Gohl, Schneider, Rehder, Omari,
// Achtelik, Siegwart, IJRR 2016], of which the left camera is played:
//   mav0/cam0/data.csv     lines `nanoseconds,file`, files in mav0/cam0/data/
//   mav0/cam0/sensor.yaml  resolution, intrinsics, radial-tangential distortion, rate, and T_BS,
//   the
//                          pose of the camera in the body's frame
//   mav0/state_groundtruth_estimate0/data.csv   optional: lines
//                          `nanoseconds,px,py,pz,qw,qx,qy,qz,...`, the body in the world, m;
//                          else mocap0/ or vicon0/, of a marker whose place on the body its
//                          sensor.yaml says, if there is one
//
// TUM-VI [Schubert, Goll, Demmel, Usenko, Stückler, Cremers, IROS 2018] is published in this
// layout, with mocap0/ for the body and, in place of sensor.yaml, dso/camchain.yaml, which has its
// fisheye's calibration and T_cam_imu. Fisheyes are not modelled: undistort the images, and name
// their calibration with --camera.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

/// True for the folder that holds mav0/, and for mav0/ itself.
bool IsEurocFolder(const std::string& path);

/// Likewise, where dso/camchain.yaml is beside mav0/ and no sensor.yaml in it.
bool IsTumViFolder(const std::string& path);

/// Truth is that of the camera, world_from_body * body_from_cam. Throws std::runtime_error with one
/// line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenEurocFolder(const std::string& path, const SourceOptions& options);
std::unique_ptr<ImageSource> OpenTumViFolder(const std::string& path, const SourceOptions& options);

}  // namespace vpslam
