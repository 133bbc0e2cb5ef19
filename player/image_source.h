// Where images come from: a data set, and whatever else gets a file of its own.
//
// A source delivers its frames in order, with strictly increasing time stamps. It skips a single
// bad frame, telling so, and gives up on a source that is bad as a whole (see BadFrameGuard). What
// makes going on impossible is thrown as std::runtime_error with one line that names what is
// wrong, where, and the remedy. What was not delivered is in its report, and so is what was read
// otherwise than it is written.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "core/messages/frame_features.h"

namespace vpslam {

struct SourceOptions {
  std::string kind;         ///< one of SourceKindNames(); empty: the one that is recognised
  std::string camera_file;  ///< empty: the source's own calibration
  int64_t start = 0;        ///< leave out that many frames at the beginning
  int64_t max_frames = 0;   ///< end after that many frames; 0: when the source does
  double fps = 0;           ///< Hz, for sources without time stamps; 0: what the calibration says
  int width = 0;            ///< px, asked of a live camera; 0: what the calibration says
  int height = 0;
  std::string pixel_format;  ///< asked of a live camera, four letters; empty: MJPG if it has that
  std::string mask_file;     ///< --mask, over that of the calibration; empty: none
  bool features = false;     ///< of a log: its features, even if it has images
  /// Called with one line about each thing that was skipped, from any thread.
  std::function<void(const std::string&)> tell = [](const std::string&) {};

  std::optional<std::string> Validate() const {
    if (start < 0) return "start must not be negative";
    if (max_frames < 0) return "frames must not be negative";
    if (!(fps >= 0) || fps > 10000) return "fps must lie in 0 to 10000";
    if (!pixel_format.empty() && pixel_format.size() != 4) {
      return "a pixel format has four letters, such as MJPG or YUYV";
    }
    if (width < 0 || height < 0) return "width and height must not be negative";
    return std::nullopt;
  }
};

struct SourceFrame {
  int64_t stamp_us = 0;
  cv::Mat grey;  ///< CV_8UC1, of the camera's size, as the lens sees it
  double decode_ms = 0;
  /// In place of an image, from a source that HasFeatures().
  std::shared_ptr<const FrameFeatures> features = {};
};

/// What became of the images of a source; of those that --start and --frames ask for.
struct SourceReport {
  std::optional<int64_t> expected;  ///< how many there should have been; nullopt: not known
  /// How many were not delivered, by the reason, which goes with a number: "3 (is truncated)".
  std::map<std::string, int64_t> skipped;
  std::string without_end;  ///< why the end is missing, where it is not known how much that is
  /// What else a person had better know of what was played; a line each.
  std::vector<std::string> notes;
};

class ImageSource {
 public:
  virtual ~ImageSource() = default;

  virtual const Camera& camera() const = 0;

  /// True for a camera: it does not wait, and must not be read ahead.
  virtual bool IsLive() const { return false; }

  /// True for a log without pixels: its frames are features and lines that were found before.
  virtual bool HasFeatures() const { return false; }

  /// Waits until Next() would not wait long: at most `patience`, and false after that. Only a
  /// camera keeps one waiting.
  virtual bool WaitReady(std::chrono::milliseconds /*patience*/) { return true; }

  /// The next frame; nullopt at the end. Throws where going on makes no sense.
  virtual std::optional<SourceFrame> Next() = 0;

  /// The true pose at a time, where it is known. May be called while another thread is in Next().
  virtual std::optional<SE3> WorldFromCam(int64_t /*stamp_us*/) const { return std::nullopt; }

  /// One line on what a person had better know from the start; empty if there is nothing.
  virtual std::string Notice() const { return {}; }

  /// To be asked after the end.
  virtual SourceReport Report() { return {}; }
};

}  // namespace vpslam
