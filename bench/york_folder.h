// A folder in the manner of the York Urban database [Denis08]: P. Denis, J. Elder, F. Estrada,
// "Efficient edge-based methods for estimating Manhattan frames in urban imagery", ECCV 2008.
//
// images/NAME.jpg (or .png); camera.yaml; manhattan.txt: NAME and three directions x y z in camera
// axes; lines.txt, which may be missing: NAME x1 y1 x2 y2 axis, annotated segments in px.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/camera.h"

namespace vpslam {

struct AnnotatedSegment {
  Eigen::Vector2d start_px, end_px;
  int32_t axis = -1;  ///< 0 to 2, column of the truth
};

struct YorkImage {
  std::string name;
  std::string file;
  Eigen::Matrix3d truth;  ///< columns: the directions, unit; signs are open, so it may mirror
  std::vector<AnnotatedSegment> segments;
};

struct YorkFolder {
  Camera camera;
  std::vector<YorkImage> images;  ///< in the order of manhattan.txt
  bool has_segments = false;
};

/// Throws std::runtime_error with one line naming file, fault and remedy.
YorkFolder ReadYorkFolder(const std::string& folder);

}  // namespace vpslam
