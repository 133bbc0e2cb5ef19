#include "player/live_camera.h"

#include <condition_variable>
#include <cstdint>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "core/base/stopwatch.h"
#include "player/bad_frame_guard.h"
#include "player/frame_check.h"

namespace vpslam {
namespace {

class LiveCamera : public ImageSource {
 public:
  LiveCamera(std::unique_ptr<FrameCapture> capture, const Camera& camera, std::string camera_name,
             const SourceOptions& options)
      : capture_(std::move(capture)),
        camera_(camera),
        camera_name_(std::move(camera_name)),
        options_(options),
        guard_(0) {}

  ~LiveCamera() override { Stop(); }

  const Camera& camera() const override { return camera_; }
  bool IsLive() const override { return true; }

  /// The camera is read from the first call on, by a thread that never waits for the graph.
  std::optional<SourceFrame> Next() override {
    if (options_.max_frames > 0 && delivered_ >= options_.max_frames) return std::nullopt;
    if (!thread_.joinable()) thread_ = std::thread([this] { Run(); });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return newest_ || !end_.empty(); });
    if (!newest_) throw std::runtime_error(end_);
    ++delivered_;
    return std::exchange(newest_, std::nullopt);
  }

  std::string Summary() override {
    Stop();
    if (guard_.bad() == 0 && left_out_ == 0) return {};
    return fmt::format(
        "{}: played {} frames; left out {} that came while others were worked on, "
        "and {} bad ones",
        capture_->name(), delivered_, left_out_, guard_.bad());
  }

 private:
  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    if (thread_.joinable()) thread_.join();
  }

  void Run() {
    std::string end;
    try {
      while (end.empty()) {
        auto captured = capture_->Read();
        Stopwatch watch;
        {
          const std::lock_guard lock(mutex_);
          if (stop_) return;
        }
        end = captured ? Take(*captured, &watch)
                       : capture_->name() +
                             ": the camera delivers no more frames; is it still "
                             "plugged in?";
      }
    } catch (const std::exception& e) {
      end = fmt::format("{}: reading the camera failed ({}); plug it in again", capture_->name(),
                        e.what());
    }
    const std::lock_guard lock(mutex_);
    end_ = std::move(end);
    changed_.notify_all();
  }

  /// Why to give up; empty to go on.
  std::string Take(const CapturedFrame& captured, Stopwatch* watch) {
    std::string fault = FaultOfFrame(captured.pixels, camera_, camera_name_);
    if (fault.empty() && captured.stamp_us <= last_stamp_us_) fault = "has a repeated time stamp";
    const int64_t index = index_++;
    if (!fault.empty()) {
      const std::string what = fmt::format("{}: frame {} {}", capture_->name(), index, fault);
      if (const auto why = guard_.CountBad()) {
        return fmt::format("{}; {}; name a calibration for this camera and size with --camera",
                           what, *why);
      }
      options_.tell(what + ", skipped");
      return {};
    }
    guard_.CountGood();
    last_stamp_us_ = captured.stamp_us;
    if (index < options_.start) return {};
    SourceFrame frame{captured.stamp_us, ToGrey(captured.pixels).clone(), 0};
    frame.decode_ms = watch->Lap_ms();
    const std::lock_guard lock(mutex_);
    if (newest_) ++left_out_;
    newest_ = std::move(frame);
    changed_.notify_all();
    return {};
  }

  std::unique_ptr<FrameCapture> capture_;
  const Camera camera_;
  const std::string camera_name_;
  const SourceOptions options_;

  // The thread's own until it ends.
  BadFrameGuard guard_;
  int64_t index_ = 0;
  int64_t last_stamp_us_ = std::numeric_limits<int64_t>::min();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<SourceFrame> newest_;
  std::string end_;  // why there are no more frames
  int64_t left_out_ = 0;
  bool stop_ = false;

  int64_t delivered_ = 0;
  std::thread thread_;
};

constexpr std::string_view kPrefix = "camera:";

}  // namespace

bool IsLiveCamera(const std::string& name) {
  return name.starts_with(kPrefix) || name.starts_with("/dev/video") ||
         name.find("://") != std::string::npos;
}

std::unique_ptr<ImageSource> OpenLiveCamera(const std::string& name, const SourceOptions& options) {
  const std::string device = name.starts_with(kPrefix) ? name.substr(kPrefix.size()) : name;
  if (options.camera_file.empty()) {
    throw std::runtime_error(name +
                             ": a camera has to be calibrated; name the calibration file "
                             "with --camera");
  }
  Camera camera = ReadCameraFile(options.camera_file);
  const int width = options.width > 0 ? options.width : camera.width;
  const int height = options.height > 0 ? options.height : camera.height;
  try {
    camera = ScaledCamera(camera, width, height);
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(options.camera_file + ": " + e.what());
  }
  if (options.fps > 0) camera.fps = options.fps;
  return MakeLiveCamera(OpenCapture(device, {width, height, camera.fps}), camera,
                        options.camera_file, options);
}

std::unique_ptr<ImageSource> MakeLiveCamera(std::unique_ptr<FrameCapture> capture,
                                            const Camera& camera, const std::string& camera_name,
                                            const SourceOptions& options) {
  return std::make_unique<LiveCamera>(std::move(capture), camera, camera_name, options);
}

Camera ScaledCamera(const Camera& camera, int width, int height) {
  if (width == camera.width && height == camera.height) return camera;
  if (int64_t{width} * camera.height != int64_t{height} * camera.width) {
    throw std::runtime_error(fmt::format(
        "is for {} x {} px, which does not have the shape of {} x {}; calibrate the camera at that "
        "size",
        camera.width, camera.height, width, height));
  }
  const double factor = static_cast<double>(width) / camera.width;
  Camera scaled = camera;
  scaled.width = width;
  scaled.height = height;
  scaled.fx *= factor;
  scaled.fy *= factor;
  scaled.cx = (camera.cx + 0.5) * factor - 0.5;  // pixel centres have integer coordinates
  scaled.cy = (camera.cy + 0.5) * factor - 0.5;
  if (const auto why = scaled.Validate()) throw std::runtime_error(*why);
  return scaled;
}

}  // namespace vpslam
