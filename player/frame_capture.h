// A camera as the live source sees it; an interface, so that tests can put another in its place.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace vpslam {

struct CapturedFrame {
  cv::Mat pixels;  ///< 8 bits, grey, BGR or BGRA
  /// When it was taken, as far as driver or stream tell, else when it was read.
  int64_t stamp_us = 0;
};

/// What a device says that it gives; 0 and empty where it does not.
struct CaptureMode {
  int width = 0, height = 0;  ///< px
  double fps = 0;
  std::string pixel_format;  ///< four letters, such as MJPG, YUYV
};

class FrameCapture {
 public:
  virtual ~FrameCapture() = default;

  /// Of the device, for messages.
  virtual std::string name() const = 0;
  virtual CaptureMode mode() const { return {}; }

  /// Waits for the next frame; nullopt if the camera has gone.
  virtual std::optional<CapturedFrame> Read() = 0;
};

/// What to ask the device for; it may give something else.
struct CaptureRequest {
  int width = 0, height = 0;  ///< px
  double fps = 0;
  std::string pixel_format;  ///< four letters; empty: MJPG if there is that, else the device's own
};

/// Opens, through OpenCV, V4L2 device N ("N" or "/dev/videoN"), or a stream's URL. A video file
/// stands in for a camera that takes its pictures at `fps` and vanishes at its end. Throws
/// std::runtime_error with one line naming device, fault and remedy.
std::unique_ptr<FrameCapture> OpenCapture(const std::string& device, const CaptureRequest& request);

}  // namespace vpslam
