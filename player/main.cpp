// player: plays a sequence of images into the graph, or renders a simulated one to files.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "core/transport/process.h"
#include "player/decode_ahead.h"
#include "player/play.h"
#include "player/render_to_folder.h"
#include "player/source_factory.h"
#include "player/truth_file.h"

namespace {

using namespace vpslam;

// These outlive the thread that handles signals.
std::atomic<bool> stop = false;
std::atomic<bool> is_opening = false;

/// A stream from the network that does not answer, or a camera's driver, cannot be called off, and
/// nothing was played that could be lost.
[[noreturn]] void EndAtOnce(Process& process) {
  process.status.SetState(ProcessState::kFinished, "stopped before the sequence was open");
  spdlog::info("stopped before the sequence was open");
  spdlog::default_logger()->flush();
  std::_Exit(kExitOk);
}

int Run(Process& process, const std::string& sequence, SourceOptions source_options,
        PlayOptions play_options, const std::string& truth_path) {
  process.OnStopSignal([&process] {
    stop = true;
    process.bus.Notify();
    if (is_opening) EndAtOnce(process);
  });
  source_options.tell = [](const std::string& line) { spdlog::warn("{}", line); };
  play_options.pace = process.options.pace;
  play_options.required = process.options.required;
  play_options.record = process.options.record;

  std::optional<TruthFile> truth;
  if (!truth_path.empty()) {
    truth.emplace(truth_path);
    play_options.on_truth = [&truth](int64_t stamp_us, const SE3& pose) {
      truth->Add(stamp_us, pose);
    };
  }

  is_opening = true;
  std::unique_ptr<ImageSource> source = OpenSource(sequence, source_options);
  is_opening = false;
  if (!source->IsLive()) source = std::make_unique<DecodeAhead>(std::move(source));
  const Camera& c = source->camera();
  spdlog::info("playing {}: {} x {} px at {:g} Hz", sequence, c.width, c.height, c.fps);
  const int64_t sent =
      Play(process.bus, process.peers, process.status, *source, play_options, stop);
  spdlog::info("sent {} images{}", sent, stop ? ", then stopped" : "");
  return kExitOk;
}

/// Needs no graph and no network, so it has a command line of its own.
int Render(int argc, char** argv) {
  CLI::App app(
      "Renders a simulated sequence to a folder in the layout of the TUM RGB-D benchmark.");
  std::string scene, folder;
  app.add_option("--render", scene,
                 "sim:room or sim:corridor; with keys: sim:room?seed=1&frames=600&noise=1&"
                 "distortion=0")
      ->required();
  app.add_option("--to", folder, "folder to write, new or empty")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  }
  try {
    simulator::Simulator simulator = simulator::Simulator::Create(scene);
    RenderToFolder(simulator, folder, [&simulator](int written) {
      if (written % 100 == 0 || written == simulator.frames()) {
        spdlog::info("rendered {} of {} frames", written, simulator.frames());
      }
    });
    spdlog::info("{} holds images, truth, camera.yaml, lines3d.txt and manhattan.txt", folder);
    return kExitOk;
  } catch (const std::exception& e) {
    spdlog::error("{}", e.what());
    return kExitFailed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (std::any_of(argv + 1, argv + argc,
                  [](std::string_view arg) { return arg.starts_with("--render"); })) {
    return Render(argc, argv);
  }
  CLI::App app("Plays a sequence of images into the VP-SLAM process graph.");
  std::string sequence, truth_path;
  SourceOptions source_options;
  PlayOptions play_options;
  ProcessOptions options;
  options.name = "player";
  options.required = {"frontend"};
  app.footer("player --render sim:room --to DIR writes a simulated sequence to files instead.");
  app.add_option(
         "sequence", sequence,
         "folder of a sequence (TUM RGB-D, ETH3D, EuRoC, TUM-VI, KITTI, ICL-NUIM, TartanAir, "
         "7-Scenes, or images), one series of a folder's images ('folder/left*.png'), video "
         "file, camera:0, log of a run, sim:room or sim:corridor")
      ->required();
  app.add_option("--source", source_options.kind, "kind of the sequence, if not the recognised one")
      ->check(CLI::IsMember(SourceKindNames()));
  app.add_option("--camera", source_options.camera_file,
                 "calibration file, instead of the sequence's own");
  app.add_option("--start", source_options.start, "leave out that many frames at the beginning")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--frames", source_options.max_frames, "end after that many frames; 0: play all")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--fps", source_options.fps,
                 "frames per second of images, a video or a camera; default: the file's or the "
                 "calibration's")
      ->check(CLI::PositiveNumber);
  app.add_option("--width", source_options.width,
                 "px, asked of a camera; the calibration is scaled to it")
      ->check(CLI::PositiveNumber);
  app.add_option("--height", source_options.height, "px, likewise")->check(CLI::PositiveNumber);
  app.add_option("--pixel-format", source_options.pixel_format,
                 "asked of a camera, such as MJPG, YUYV, GREY; default: MJPG if it has that");
  app.add_option(
      "--mask", source_options.mask_file,
      "picture of the images' size: where it is black they are not used, since what moves "
      "with the camera is there");
  app.add_flag("--features", source_options.features,
               "of a log: play its features, even if it has images");
  app.add_option("--truth", truth_path,
                 "file to write the true poses of the played frames to, where the source has them");
  app.add_flag("--inline", play_options.inline_pixels,
               "send pixels in the messages, for other hosts and logs, instead of shared memory");
  AddProcessOptions(app, &options);
  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    return Run(process, sequence, source_options, play_options, truth_path);
  });
}
