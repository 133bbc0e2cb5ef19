// What sharing the detection of lines between processes costs and brings: plays preloaded images
// without a loss, waits for their lines as the frontend does, and measures frames per second and
// the CPU time of each instance of vpdetector.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/messages/process_status.h"
#include "core/transport/camera_link.h"
#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "core/transport/image_pool.h"
#include "core/transport/inbox.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"
#include "core/transport/status_reporter.h"
#include "frontend/line_source.h"
#include "player/source_factory.h"

namespace {

using namespace vpslam;
namespace fs = std::filesystem;

/// A vpdetector of our own, killed in the end.
class Child {
 public:
  Child(const std::string& program, const std::string& url) {
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("no process can be started");
    if (pid_ == 0) {
      execl(program.c_str(), program.c_str(), "--url", url.c_str(), "--log-level", "error",
            static_cast<char*>(nullptr));
      _exit(127);
    }
  }
  ~Child() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  double Cpu_ms() const {
    clockid_t clock{};
    timespec time{};
    if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  }

 private:
  pid_t pid_ = -1;
};

struct Result {
  double fps = 0;
  std::vector<double> cpu_ms;   ///< per instance, in all
  std::vector<int64_t> frames;  ///< per instance, in order of their sessions
  double CpuPerFrame_ms() const {
    double cpu = 0, n = 0;
    for (const double ms : cpu_ms) cpu += ms;
    for (const int64_t f : frames) n += static_cast<double>(f);
    return cpu / n;
  }
};

Result Measure(const std::string& program, const Camera& camera, const std::vector<cv::Mat>& images,
               int instances, int num_frames) {
  BusOptions options;
  options.url = fmt::format("udpm://239.255.76.67:{}", 20000 + getpid() % 20000);
  Bus bus(options);
  Peers peers(bus);
  Inbox<ProcessStatus> statuses(bus, kStatusChannel, Inbox<ProcessStatus>::kUnbounded);
  Inbox<LineSet> lines(bus, kLinesChannel, Inbox<LineSet>::kUnbounded);
  const CameraBeacon beacon(bus, camera);
  LineSource source(bus, peers, LineSourceOptions::ForPace(Pace::kLossless));
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < instances; ++i)
    children.push_back(std::make_unique<Child>(program, bus.url()));

  std::map<int64_t, ProcessState> states;  // by session
  const bool ready = bus.WaitFor(
      [&] {
        while (const auto s = statuses.TryTake()) {
          if (s->value.process == LineSource::kDetector) states[s->header.session] = s->value.state;
        }
        return std::count_if(states.begin(), states.end(), [](const auto& s) {
                 return s.second == ProcessState::kRunning;
               }) == instances;
      },
      std::chrono::seconds(30));
  if (!ready) throw std::runtime_error(program + ": did not get ready; is it a vpdetector?");

  const int window = 2 * instances + 1;
  ImagePool pool(ImageSegmentName(bus.session()), window + 1,
                 static_cast<size_t>(camera.width) * camera.height);
  Publisher<ImageMessage> publisher(bus, kImageChannel);
  std::map<int64_t, int64_t> answered;  // by session
  const auto play = [&](int begin, int end) {
    std::vector<ImageFrame> sent;
    for (int next = begin, done = begin; done < end; ++done) {
      for (; next < std::min(end, done + window); ++next) {
        ImageFrame image;
        image.frame_seq = next;
        image.stamp_us = 1000 * next;
        image.published_us = MonotonicMicroseconds();
        image.pixels = images[static_cast<size_t>(next) % images.size()];
        publisher.Publish(pool.Store(image));
        source.AddImage(bus.session(), image.frame_seq);
        sent.push_back(image);
      }
      if (!source.WaitFor(sent[static_cast<size_t>(done - begin)])) {
        throw std::runtime_error("an image came to no lines");
      }
    }
    while (const auto message = lines.TryTake()) ++answered[message->header.session];
  };
  const int warm_up = 10 * instances;
  play(0, warm_up);
  answered.clear();
  Result result;
  for (const auto& child : children) result.cpu_ms.push_back(-child->Cpu_ms());
  const auto start = std::chrono::steady_clock::now();
  play(warm_up, warm_up + num_frames);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  for (size_t i = 0; i < children.size(); ++i) result.cpu_ms[i] += children[i]->Cpu_ms();
  result.fps = num_frames / took.count();
  for (const auto& [session, frames] : answered) result.frames.push_back(frames);
  return result;
}

double LoadAverage() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : -1;
}

void Run(const std::string& sequence, const std::string& program, int num_images, int num_frames,
         int repetitions) {
  SourceOptions options;
  options.max_frames = num_images;
  const auto source = OpenSource(sequence, options);
  std::vector<cv::Mat> images;
  while (auto frame = source->Next()) images.push_back(frame->grey);
  if (images.empty()) throw std::runtime_error(sequence + ": has no images");
  std::cout << fmt::format(
      "{} images, each played {:.1f} times over; {} cores\n\n"
      "| load before | detectors | frames/s | frames of each | CPU per frame (ms) | against one |\n"
      "|---|---|---|---|---|---|\n",
      images.size(), num_frames / static_cast<double>(images.size()),
      sysconf(_SC_NPROCESSORS_ONLN));
  for (int i = 0; i < repetitions; ++i) {
    Result one;
    for (const int instances : {1, 2}) {
      const double load = LoadAverage();
      const Result r = Measure(program, source->camera(), images, instances, num_frames);
      if (instances == 1) one = r;
      std::string shares;
      for (const int64_t n : r.frames) shares += fmt::format("{}{}", shares.empty() ? "" : " ", n);
      std::cout << fmt::format(
                       "| {:.2f} | {} | {:.1f} | {} | {:.2f} | {:.2f} x fps, {:+.1f} % CPU |\n",
                       load, instances, r.fps, shares, r.CpuPerFrame_ms(), r.fps / one.fps,
                       100 * (r.CpuPerFrame_ms() / one.CpuPerFrame_ms() - 1))
                << std::flush;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures how two detectors share images, against one.");
  app.set_version_flag("--version", "detector_bench " VPSLAM_VERSION);
  std::string sequence;
  std::string program = (fs::canonical("/proc/self/exe").parent_path() / "vpdetector").string();
  int images = 60, frames = 600, repetitions = 3;
  app.add_option("--data", sequence, "sequence, or sim:room, sim:corridor")->required();
  app.add_option("--vpdetector", program, "the program")->capture_default_str();
  app.add_option("--images", images, "read so many")->check(CLI::PositiveNumber);
  app.add_option("--frames", frames, "play so many")->check(CLI::PositiveNumber);
  app.add_option("--repetitions", repetitions, "")->check(CLI::PositiveNumber);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    Run(sequence, program, images, frames, repetitions);
  } catch (const std::exception& e) {
    std::cerr << "detector_bench: " << e.what() << "\n";
    return 1;
  }
  return 0;
}
