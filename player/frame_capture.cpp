#include "player/frame_capture.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

namespace vpslam {
namespace {

namespace fs = std::filesystem;

/// Microseconds since 1970 that never jump: the wall clock is read once.
class SteadyWallClock {
 public:
  int64_t Now_us() const {
    return start_us_ + std::chrono::duration_cast<std::chrono::microseconds>(
                           std::chrono::steady_clock::now() - start_)
                           .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  int64_t start_us_ = std::chrono::duration_cast<std::chrono::microseconds>(
                          std::chrono::system_clock::now().time_since_epoch())
                          .count();
};

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
    capture_.set(cv::CAP_PROP_FRAME_WIDTH, request.width);
    capture_.set(cv::CAP_PROP_FRAME_HEIGHT, request.height);
    capture_.set(cv::CAP_PROP_FPS, request.fps);
    if (fs::is_regular_file(name_, error)) {
      period_ = std::chrono::duration<double>(1 / std::max(1.0, request.fps));
    }
  }

  std::string name() const override { return name_; }

  std::optional<CapturedFrame> Read() override {
    if (period_.count() > 0) {
      std::this_thread::sleep_until(next_);
      next_ = std::chrono::steady_clock::now() +
              std::chrono::duration_cast<std::chrono::steady_clock::duration>(period_);
    }
    CapturedFrame frame;
    if (!capture_.read(frame.pixels)) return std::nullopt;
    frame.stamp_us = clock_.Now_us();
    return frame;
  }

 private:
  std::string name_;
  cv::VideoCapture capture_;
  SteadyWallClock clock_;
  std::chrono::duration<double> period_{0};  // of a file that stands in; a camera has its own
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
};

}  // namespace

std::unique_ptr<FrameCapture> OpenCapture(const std::string& device,
                                          const CaptureRequest& request) {
  return std::make_unique<OpenCvCapture>(device, request);
}

}  // namespace vpslam
