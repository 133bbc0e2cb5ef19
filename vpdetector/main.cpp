// vpdetector: lines and vanishing points of images.
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>

#include "vpdetector/image_tool.h"

int main(int argc, char** argv) {
  using namespace vpslam;
  CLI::App app("Finds line segments and vanishing points in images.");
  app.set_version_flag("--version", "vpdetector " VPSLAM_VERSION);
  ImageToolOptions options;
  std::string lines = Name(options.detector.lines.detector.kind);
  std::string method = Name(options.detector.vps.method);
  app.add_option("--image", options.images, "image files; may be given several times")->required();
  app.add_option("--camera", options.camera_file, "calibration file of the images")->required();
  app.add_option(
      "--draw", options.draw_directory,
      "folder for pictures NAME_lines.png: axes red, green, blue, unlabelled lines grey");
  app.add_option("--lines", lines, "line detector")
      ->check(CLI::IsMember({"lsd", "edlines", "fld"}))
      ->capture_default_str();
  app.add_option("--vp,--method", method, "how vanishing points are found")
      ->check(CLI::IsMember({"three_line", "two_line_grid", "two_line_grid_raw"}))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  options.detector.lines.detector.kind = *LineDetectorKindFromName(lines);
  options.detector.vps.method = *VpMethodFromName(method);
  cv::setNumThreads(1);
  try {
    RunImageTool(options, std::cout);
  } catch (const std::exception& e) {
    std::cerr << "vpdetector: " << e.what() << "\n";
    return 1;
  }
  return 0;
}
