#include "player/frame_capture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "player/capture_clock.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

/// By whose clock pictures are stamped.
enum class Timing { kDriver, kStream, kFile };

std::string NameOfFourcc(double value) {
  const auto code = static_cast<uint32_t>(std::max(0.0, value));
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(code >> (8 * i) & 0xff);
    if (c > ' ' && c <= '~') name += c;
  }
  return name;
}

class OpenCvCapture : public FrameCapture {
 public:
  OpenCvCapture(const std::string& device, const CaptureRequest& request) : name_(device) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    const bool is_number = !device.empty() && device.find_first_not_of("0123456789") == device.npos;
    if (is_number) name_ = "/dev/video" + device;
    std::error_code error;
    const bool is_device = name_.starts_with("/dev/");
    if (is_device && !fs::exists(name_, error)) {
      throw std::runtime_error(name_ +
                               ": there is no such camera; plug it in, or name another of "
                               "/dev/video*");
    }
    if (!capture_.open(name_, is_device ? cv::CAP_V4L2 : cv::CAP_ANY)) {
      throw std::runtime_error(name_ +
                               ": cannot be opened as a camera; does another program use "
                               "it, and may you read it (group video)?");
    }
    if (is_device) {
      Ask(request);
      timing_ = Timing::kDriver;
    } else {
      capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);  // a calibration belongs to the sensor
      if (fs::is_regular_file(name_, error)) {
        timing_ = Timing::kFile;
        period_ = std::chrono::duration<double>(1 / std::max(1.0, request.fps));
      }
    }
    mode_ = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
             static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT)),
             timing_ == Timing::kFile ? request.fps : capture_.get(cv::CAP_PROP_FPS),
             NameOfFourcc(capture_.get(cv::CAP_PROP_FOURCC))};
  }

  std::string name() const override { return name_; }
  CaptureMode mode() const override { return mode_; }

  std::optional<CapturedFrame> Read() override {
    if (timing_ == Timing::kFile) {
      std::this_thread::sleep_until(next_);
      next_ = std::chrono::steady_clock::now() +
              std::chrono::duration_cast<std::chrono::steady_clock::duration>(period_);
    }
    CapturedFrame frame;
    while (capture_.read(frame.pixels)) {
      const auto stamp_us = Stamp_us();
      if (!stamp_us) continue;  // of a stream's first burst
      frame.stamp_us = *stamp_us;
      return frame;
    }
    return std::nullopt;
  }

 private:
  /// USB carries 9 to 10 raw images of 1280 x 720 px a second, and OpenCV takes raw ones if there
  /// are any. The format is asked for first: size and rate depend on it.
  void Ask(const CaptureRequest& request) {
    const std::string format = request.pixel_format.empty() ? "MJPG" : request.pixel_format;
    capture_.set(cv::CAP_PROP_FOURCC,
                 cv::VideoWriter::fourcc(format[0], format[1], format[2], format[3]));
    const std::string given = NameOfFourcc(capture_.get(cv::CAP_PROP_FOURCC));
    if (!request.pixel_format.empty() && given != format) {
      throw std::runtime_error(name_ + ": does not give " + format + ", but " + given +
                               "; name another --pixel-format (v4l2-ctl --list-formats-ext), or "
                               "leave it out");
    }
    capture_.set(cv::CAP_PROP_FRAME_WIDTH, request.width);
    capture_.set(cv::CAP_PROP_FRAME_HEIGHT, request.height);
    capture_.set(cv::CAP_PROP_FPS, request.fps);
  }

  std::optional<int64_t> Stamp_us() {
    const int64_t read_us = clock_.Now_us();
    if (timing_ == Timing::kFile) return read_us;
    const int64_t own_us = std::llround(1e3 * capture_.get(cv::CAP_PROP_POS_MSEC));
    if (timing_ == Timing::kDriver) return CaptureTime_us(own_us, read_us, clock_);
    return stream_clock_.Stamp_us(own_us, read_us);
  }

  std::string name_;
  cv::VideoCapture capture_;
  CaptureMode mode_;
  Timing timing_ = Timing::kStream;
  SteadyWallClock clock_;
  StreamClock stream_clock_;
  std::chrono::duration<double> period_{0};  // of a file that stands in; a camera has its own
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
};

}  // namespace

std::unique_ptr<FrameCapture> OpenCapture(const std::string& device,
                                          const CaptureRequest& request) {
  return std::make_unique<OpenCvCapture>(device, request);
}

}  // namespace vpslam
