// player: plays a sequence of images into the graph.
#include <atomic>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "core/transport/process.h"
#include "player/decode_ahead.h"
#include "player/play.h"
#include "player/source_factory.h"

namespace {

using namespace vpslam;

std::atomic<bool> stop = false;  // outlives the thread that handles signals

int Run(Process& process, const std::string& sequence, SourceOptions source_options,
        PlayOptions play_options) {
  process.OnStopSignal([&process] {
    stop = true;
    process.bus.Notify();
  });
  source_options.tell = [](const std::string& line) { spdlog::warn("{}", line); };
  play_options.required = process.options.required;

  DecodeAhead source(OpenSource(sequence, source_options));
  const Camera& c = source.camera();
  spdlog::info("playing {}: {} x {} px at {:g} Hz", sequence, c.width, c.height, c.fps);
  const int64_t sent = Play(process.bus, process.peers, process.status, source, play_options, stop);
  if (const std::string skipped = source.Summary(); !skipped.empty()) spdlog::warn("{}", skipped);
  spdlog::info("sent {} images{}", sent, stop ? ", then stopped" : "");
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Plays a sequence of images into the VP-SLAM process graph.");
  std::string sequence;
  SourceOptions source_options;
  PlayOptions play_options;
  ProcessOptions options;
  options.name = "player";
  options.required = {"frontend"};
  app.add_option("sequence", sequence, "folder with rgb.txt and camera.yaml (TUM RGB-D layout)")
      ->required();
  app.add_option("--camera", source_options.camera_file,
                 "calibration file, instead of the sequence's camera.yaml");
  app.add_option("--start", source_options.start, "leave out that many frames at the beginning")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--frames", source_options.max_frames, "end after that many frames; 0: play all")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--inline", play_options.inline_pixels,
               "send pixels in the messages, for other hosts and logs, instead of shared memory");
  AddProcessOptions(app, &options);
  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    return Run(process, sequence, source_options, play_options);
  });
}
