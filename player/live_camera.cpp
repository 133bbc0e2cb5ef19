#include "player/live_camera.h"

#include <algorithm>
#include <chrono>
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
#include "core/geometry/image_mask.h"
#include "player/bad_frame_guard.h"
#include "player/frame_check.h"

namespace vpslam {
namespace {

using Clock = std::chrono::steady_clock;

/// Reads a camera in a thread of its own, and keeps the newest frame. The thread owns what it works
/// on together with the source: a driver that does not return is left behind with it.
class CameraReader {
 public:
  CameraReader(std::unique_ptr<FrameCapture> capture, const Camera& camera, std::string camera_name,
               const SourceOptions& options)
      : name_(capture->name()),
        capture_(std::move(capture)),
        camera_(camera),
        camera_name_(std::move(camera_name)),
        options_(options),
        guard_(0) {}

  const std::string& name() const { return name_; }

  /// A frame is there, or the reason why none comes; false after `patience`.
  bool WaitReady(Clock::time_point until) {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(lock, until, [this] { return newest_ || !end_.empty(); });
  }
  /// nullopt if there is none. Throws std::runtime_error when there will be no more.
  std::optional<SourceFrame> Take() {
    const std::lock_guard lock(mutex_);
    if (!newest_ && !end_.empty()) throw std::runtime_error(end_);
    return std::exchange(newest_, std::nullopt);
  }
  void AskToStop() {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  /// Run() has returned; false after `patience`.
  bool WaitUntilStopped(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [this] { return stopped_; });
  }
  int64_t left_out() const {
    const std::lock_guard lock(mutex_);
    return left_out_;
  }
  int bad() const {
    const std::lock_guard lock(mutex_);
    return bad_;
  }

  void Run() {
    std::string end;
    try {
      while (end.empty()) {
        auto captured = capture_->Read();
        Stopwatch watch;
        {
          const std::lock_guard lock(mutex_);
          if (stop_) break;
        }
        end = captured ? Take(*captured, &watch)
                       : name_ + ": the camera delivers no more frames; is it still plugged in?";
      }
    } catch (const cv::Exception& e) {
      end = fmt::format("{}: reading the camera failed ({}); plug it in again", name_, e.err);
    } catch (const std::exception& e) {
      end = fmt::format("{}: reading the camera failed ({}); plug it in again", name_, e.what());
    }
    const std::lock_guard lock(mutex_);
    end_ = std::move(end);
    stopped_ = true;
    changed_.notify_all();
  }

 private:
  /// Why to give up; empty to go on.
  std::string Take(const CapturedFrame& captured, Stopwatch* watch) {
    std::string fault = FaultOfFrame(captured.pixels, camera_, camera_name_);
    if (fault.empty() && captured.stamp_us <= last_stamp_us_) fault = "has a repeated time stamp";
    const int64_t index = index_++;
    if (!fault.empty()) {
      const std::string what = fmt::format("{}: frame {} {}", name_, index, fault);
      const auto why = guard_.CountBad();
      {
        const std::lock_guard lock(mutex_);
        bad_ = guard_.bad();
      }
      if (why) {
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

  const std::string name_;

  // The thread's own.
  std::unique_ptr<FrameCapture> capture_;
  const Camera camera_;
  const std::string camera_name_;
  const SourceOptions options_;
  BadFrameGuard guard_;
  int64_t index_ = 0;
  int64_t last_stamp_us_ = std::numeric_limits<int64_t>::min();

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::optional<SourceFrame> newest_;
  std::string end_;  // why there are no more frames
  int64_t left_out_ = 0;
  int bad_ = 0;
  bool stop_ = false;
  bool stopped_ = false;
};

class LiveCamera : public ImageSource {
 public:
  LiveCamera(std::unique_ptr<FrameCapture> capture, const Camera& camera,
             const std::string& camera_name, const SourceOptions& options,
             const LiveCameraPatience& patience)
      : mode_(capture->mode()),
        asked_fps_(camera.fps),
        camera_(AtRate(camera, mode_.fps)),
        options_(options),
        patience_(patience),
        reader_(std::make_shared<CameraReader>(std::move(capture), camera, camera_name, options)) {}

  ~LiveCamera() override { Stop(); }

  const Camera& camera() const override { return camera_; }
  bool IsLive() const override { return true; }
  std::string Notice() const override {
    if (mode_.width == 0) return {};
    std::string notice = fmt::format("{} gives {} x {} px at {:.4g} Hz{}", reader_->name(),
                                     mode_.width, mode_.height, camera_.fps,
                                     mode_.pixel_format.empty() ? "" : " as " + mode_.pixel_format);
    if (camera_.fps < kSlow * asked_fps_) {
      notice += fmt::format(
          ", not the {:.4g} Hz that were asked for; try another --pixel-format or a smaller "
          "--width "
          "and --height",
          asked_fps_);
    }
    return notice;
  }

  /// The camera is read from the first call of this or of Next() on.
  bool WaitReady(std::chrono::milliseconds patience) override {
    Start();
    if (IsAtItsEnd()) return true;
    const auto now = Clock::now();
    return reader_->WaitReady(std::min(now + patience, last_frame_ + patience_.stalled)) ||
           Clock::now() >= last_frame_ + patience_.stalled;
  }

  std::optional<SourceFrame> Next() override {
    if (IsAtItsEnd()) return std::nullopt;
    Start();
    const bool came = reader_->WaitReady(last_frame_ + patience_.stalled);
    if (!came) {
      throw std::runtime_error(
          fmt::format("{}: no frame came for {} s; plug it in again, or see whether it sends",
                      reader_->name(), std::chrono::duration<double>(patience_.stalled).count()));
    }
    auto frame = reader_->Take();
    last_frame_ = Clock::now();
    ++delivered_;
    return frame;
  }

  SourceReport Report() override {
    Stop();
    SourceReport report;
    report.expected = delivered_ + reader_->left_out() + reader_->bad();
    if (reader_->left_out() > 0) {
      report.skipped["came while others were worked on"] = reader_->left_out();
    }
    if (reader_->bad() > 0) report.skipped["is bad"] = reader_->bad();
    return report;
  }

 private:
  static constexpr double kSlow = 0.9;  // below this share of the rate that was asked for

  static Camera AtRate(Camera camera, double fps) {
    if (fps > 0 && fps < 10000) camera.fps = fps;  // as the device says
    return camera;
  }
  bool IsAtItsEnd() const { return options_.max_frames > 0 && delivered_ >= options_.max_frames; }

  void Start() {
    if (thread_.joinable() || stopped_) return;
    last_frame_ = Clock::now();
    thread_ = std::thread([reader = reader_] { reader->Run(); });
  }

  void Stop() {
    stopped_ = true;
    if (!thread_.joinable()) return;
    reader_->AskToStop();
    if (reader_->WaitUntilStopped(patience_.stop)) {
      thread_.join();
      return;
    }
    options_.tell(reader_->name() + ": its driver does not answer; it is left behind");
    thread_.detach();
  }

  const CaptureMode mode_;
  const double asked_fps_;
  const Camera camera_;
  const SourceOptions options_;
  const LiveCameraPatience patience_;
  const std::shared_ptr<CameraReader> reader_;
  int64_t delivered_ = 0;
  bool stopped_ = false;
  Clock::time_point last_frame_;
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
  auto capture = OpenCapture(device, {width, height, camera.fps, options.pixel_format});
  const CaptureMode mode = capture->mode();
  if (mode.width > 0 && mode.height > 0 && (mode.width != width || mode.height != height)) {
    throw std::runtime_error(
        fmt::format("{}: gives {} x {} px, not the {} x {} of {}; calibrate it at that size, or "
                    "ask for another "
                    "with --width and --height",
                    capture->name(), mode.width, mode.height, width, height, options.camera_file));
  }
  return MakeLiveCamera(std::move(capture), camera, options.camera_file, options);
}

std::unique_ptr<ImageSource> MakeLiveCamera(std::unique_ptr<FrameCapture> capture,
                                            const Camera& camera, const std::string& camera_name,
                                            const SourceOptions& options,
                                            const LiveCameraPatience& patience) {
  return std::make_unique<LiveCamera>(std::move(capture), camera, camera_name, options, patience);
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
  scaled.mask_runs = ImageMask(camera.mask_runs, camera.width, camera.height).Scaled(width, height);
  if (const auto why = scaled.Validate()) throw std::runtime_error(*why);
  return scaled;
}

}  // namespace vpslam
