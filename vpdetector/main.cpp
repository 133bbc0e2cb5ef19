// vpdetector: lines and vanishing points of images; as a process of the graph, or as a tool.
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>
#include <spdlog/spdlog.h>

#include "core/base/settings.h"
#include "core/transport/process.h"
#include "vpdetector/detector_process.h"
#include "vpdetector/detector_settings.h"
#include "vpdetector/image_tool.h"

namespace {

using namespace vpslam;

/// What either use may be told of the method.
struct DetectorArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string lines, method;

  void AddTo(CLI::App& app) {
    const DetectorOptions defaults;
    app.add_option("--lines", lines, "line detector, over that of the settings")
        ->check(CLI::IsMember({"lsd", "edlines", "fld"}))
        ->default_str(Name(defaults.lines.detector.kind));
    app.add_option("--vp,--method", method,
                   "how vanishing points are found, over that of the settings")
        ->check(CLI::IsMember({"three_line", "two_line_grid", "two_line_grid_raw"}))
        ->default_str(Name(defaults.vps.method));
    app.add_option("--config", config, "settings file; section 'vpdetector' is read");
    app.add_option("--set", overrides, "one setting, over those of the file: vpdetector.key=value");
  }

  DetectorOptions Options() const {
    auto options = LoadSettings<DetectorOptions>(config, "vpdetector", overrides);
    if (!lines.empty()) options.lines.detector.kind = *LineDetectorKindFromName(lines);
    if (!method.empty()) options.vps.method = *VpMethodFromName(method);
    return options;
  }
};

/// Needs no graph and no network, so it has a command line of its own.
int RunTool(int argc, char** argv) {
  CLI::App app("Finds line segments and vanishing points in images.");
  ImageToolOptions options;
  DetectorArguments arguments;
  app.add_option("--image", options.images, "image files; may be given several times")->required();
  app.add_option("--camera", options.camera_file, "calibration file of the images")->required();
  app.add_option(
      "--draw", options.draw_directory,
      "folder for pictures NAME_lines.png: axes red, green, blue, unlabelled lines grey");
  arguments.AddTo(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  }
  try {
    options.detector = arguments.Options();
    RunImageTool(options, std::cout);
  } catch (const std::exception& e) {
    std::cerr << "vpdetector: " << e.what() << "\n";
    return kExitFailed;
  }
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // one instance is one core's work; and the cores must not matter
  if (std::any_of(argv + 1, argv + argc,
                  [](std::string_view arg) { return arg.starts_with("--image"); })) {
    return RunTool(argc, argv);
  }
  CLI::App app("Finds lines and vanishing points for the VP-SLAM process graph.");
  app.footer("vpdetector --image FILE... --camera FILE [--draw DIR] does so for image files.");
  ProcessOptions options;
  options.name = DetectorProcess::kName;
  options.may_be_several = true;
  AddProcessOptions(app, &options);
  DetectorArguments arguments;
  arguments.AddTo(app);
  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    const DetectorOptions settings = arguments.Options();
    spdlog::info("settings: {}", PrintSettings(settings));
    DetectorProcess(process.bus, process.peers, process.status, settings).Run();
    return kExitOk;
  });
}
