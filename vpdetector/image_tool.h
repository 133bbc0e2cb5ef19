// vpdetector as a tool: image files in, lines and vanishing points as text and pictures out.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"
#include "vpdetector/detector.h"

namespace vpslam {

struct ImageToolOptions {
  std::vector<std::string> images;
  std::string camera_file;
  std::string draw_directory;  ///< where NAME_lines.png goes; empty for none; made if missing
  DetectorOptions detector;
};

/// Text for every image on `out`. Throws std::runtime_error with one line naming file, fault and
/// remedy.
void RunImageTool(const ImageToolOptions& options, std::ostream& out);

/// One line for the image, then one per vanishing point and one per segment; the first word says
/// which.
void WriteLineSet(const std::string& name, const LineSet& set, std::ostream& out);

/// The picture of the paper's fig. 4: segments of the three axes in red, green and blue, those of
/// further directions in other colours, unlabelled ones grey. CV_8UC3, as the lens sees it.
cv::Mat DrawLineSet(const cv::Mat& gray, const Camera& camera, const LineSet& set);

}  // namespace vpslam
