// The whole system in one process, in lockstep and without LCM: for profiling, debugging and
// measuring. What it computes is what `scripts/vpslam run` computes in lockstep, and without
// detector what it computes with `--preset points`. `scripts/vpslam bench --suite spread` calls it.
#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "backend/mapper.h"
#include "core/base/settings.h"
#include "frontend/tracker.h"
#include "frontend/tracker_settings.h"
#include "player/source_factory.h"
#include "recorder/results.h"
#include "vpdetector/detector.h"
#include "vpdetector/detector_settings.h"

namespace vpslam {
namespace {

struct Arguments {
  std::string sequence;
  std::string out;
  SourceOptions source;
  uint64_t seed = 1;
  std::string config;
  std::vector<std::string> set;
  bool no_detector = false;
  bool verbose = false;
};

struct Settings {
  explicit Settings(const Arguments& arguments)
      : tracker(LoadSettings<TrackerOptions>(arguments.config, "frontend", arguments.set)),
        mapper(LoadSettings<MapperOptions>(arguments.config, "backend", arguments.set)),
        detector(LoadSettings<DetectorOptions>(arguments.config, "vpdetector", arguments.set)) {}

  TrackerOptions tracker;
  MapperOptions mapper;
  DetectorOptions detector;
};

void Run(const Arguments& arguments, const Settings& settings) {
  cv::setNumThreads(1);
  const auto source = OpenSource(arguments.sequence, arguments.source);
  Tracker tracker(source->camera(), settings.tracker, arguments.seed);
  Mapper mapper(source->camera(), settings.mapper);
  const Detector detector(source->camera(), settings.detector);
  RunRecord record;
  const auto take_poses = [&](const TrackerOutput& output) {
    for (const FramePose& pose : output.poses) {
      record.Add(pose);
      if (arguments.verbose) {
        std::fprintf(stderr, "frame %ld state %d live %d inliers %d/%d keyframe %ld\n",
                     static_cast<long>(pose.frame_seq), static_cast<int>(pose.state), pose.live,
                     pose.inliers, pose.matches, static_cast<long>(pose.keyframe.value));
      }
    }
  };
  const auto take_keyframes = [&](const TrackerOutput& output) {
    for (const KeyframeProposal& proposal : output.keyframes) {
      for (const MapDelta& delta : mapper.Process(proposal)) {
        if (!tracker.Apply(delta) || !record.Apply(delta)) {
          throw std::logic_error("a replica refused a delta");
        }
      }
    }
  };
  int64_t seq = 0;
  while (const auto frame = source->Next()) {
    ImageFrame image;
    image.frame_seq = seq++;
    image.stamp_us = frame->stamp_us;
    image.decode_ms = frame->decode_ms;
    image.pixels = frame->grey;
    FrameFeatures features = tracker.Extract(image);
    if (!arguments.no_detector) {
      features.lines = std::make_shared<const LineSet>(detector.Detect(image.pixels));
    }
    // As in the graph: deltas are applied when both have been tracked.
    const TrackerOutput live = tracker.Track(std::move(features));
    const TrackerOutput late = tracker.TrackLate();
    for (const auto* output : {&live, &late}) take_poses(*output);
    for (const auto* output : {&live, &late}) take_keyframes(*output);
  }
  take_poses(tracker.Finish());
  WriteResults(record, RunInfo(), ResultsFolder(arguments.out));
}

}  // namespace
}  // namespace vpslam

int main(int argc, char** argv) {
  vpslam::Arguments arguments;
  CLI::App app("The whole system in one process, without LCM");
  app.add_option("sequence", arguments.sequence)->required();
  app.add_option("--out", arguments.out)->required();
  app.add_option("--camera", arguments.source.camera_file);
  app.add_option("--start", arguments.source.start);
  app.add_option("--frames", arguments.source.max_frames);
  app.add_option("--seed", arguments.seed);
  app.add_option("--config", arguments.config);
  app.add_option("--set", arguments.set);
  app.add_flag("--no-detector", arguments.no_detector, "points alone, as --preset points");
  app.add_flag("--verbose", arguments.verbose);
  constexpr int kFailed = 1, kUsage = 2;
  int fault = kUsage;
  try {
    app.parse(argc, argv);
    const vpslam::Settings settings(arguments);
    fault = kFailed;
    vpslam::Run(arguments, settings);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : kUsage;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "offline_slam: %s\n", e.what());
    return fault;
  }
}
