#include "player/video_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/camera_file.h"
#include "core/base/stopwatch.h"
#include "player/bad_frame_guard.h"
#include "player/frame_check.h"

namespace vpslam {
namespace {

class VideoFile : public ImageSource {
 public:
  VideoFile(const std::string& path, const SourceOptions& options)
      : path_(path), options_(options), guard_(0) {
    if (options.camera_file.empty()) {
      throw std::runtime_error(path + ": a video has no calibration; name a file with --camera");
    }
    camera_ = ReadCameraFile(options.camera_file);
    // What is wrong is told by one line of ours.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    // Pixels as stored: a calibration belongs to the sensor, whichever way it was held.
    if (!video_.open(path, cv::CAP_ANY)) {
      throw std::runtime_error(path +
                               ": is no video that FFmpeg can read, or is truncated; name a "
                               "video file, or the folder of a sequence");
    }
    video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    const double rate_hz = video_.get(cv::CAP_PROP_FPS);
    if (rate_hz > 0 && rate_hz < 1000) camera_.fps = rate_hz;
    if (options.fps > 0) camera_.fps = options.fps;
    announced_ = static_cast<int64_t>(video_.get(cv::CAP_PROP_FRAME_COUNT));
    while (index_ < options.start && video_.grab()) ++index_;
  }

  const Camera& camera() const override { return camera_; }

  std::optional<SourceFrame> Next() override {
    cv::Mat pixels;
    for (;;) {
      if (options_.max_frames > 0 && index_ >= options_.start + options_.max_frames) return {};
      Stopwatch watch;
      if (!video_.read(pixels)) {
        RequireAFrame();
        return std::nullopt;
      }
      const int64_t index = index_++;
      if (const std::string fault = FaultOfFrame(pixels, camera_, options_.camera_file);
          !fault.empty()) {
        Skip(index, fault);
        continue;
      }
      guard_.CountGood();
      last_stamp_us_ = StampOf_us(index);
      return SourceFrame{last_stamp_us_, ToGrey(pixels).clone(), watch.Lap_ms()};
    }
  }

  std::string Summary() override {
    std::string summary;
    if (guard_.bad() > 0) {
      summary =
          fmt::format("{}: skipped {} bad frames; played {}", path_, guard_.bad(), guard_.good());
    }
    const bool whole = options_.max_frames == 0 && announced_ > 0;
    if (whole && static_cast<double>(index_) < 0.98 * static_cast<double>(announced_)) {
      summary += fmt::format("{}{}: ends after {} of {} frames, is it truncated?",
                             summary.empty() ? "" : "; ", path_, index_, announced_);
    }
    return summary;
  }

 private:
  int64_t StampOf_us(int64_t index) const {
    const double period_us = 1e6 / camera_.fps;
    if (options_.fps <= 0) {
      const int64_t own = std::llround(video_.get(cv::CAP_PROP_POS_MSEC) * 1e3);
      if (own > last_stamp_us_) return own;
      if (last_stamp_us_ >= 0) return last_stamp_us_ + std::llround(period_us);
    }
    return std::llround(static_cast<double>(index) * period_us);
  }

  void Skip(int64_t index, const std::string& fault) {
    const std::string what = fmt::format("{}: frame {} {}", path_, index, fault);
    if (const auto why = guard_.CountBad()) {
      throw std::runtime_error(what + "; " + *why +
                               "; correct the calibration or name another one with --camera");
    }
    options_.tell(what + ", skipped");
  }

  void RequireAFrame() const {
    if (guard_.good() > 0) return;
    if (options_.start > 0) {
      throw std::runtime_error(
          fmt::format("{}: has {} frames, and --start {} leaves none; start earlier", path_, index_,
                      options_.start));
    }
    throw std::runtime_error(path_ + ": holds no frame that can be decoded; is it truncated?");
  }

  std::string path_;
  SourceOptions options_;
  Camera camera_;
  cv::VideoCapture video_;
  BadFrameGuard guard_;
  int64_t announced_ = 0, index_ = 0;
  int64_t last_stamp_us_ = -1;
};

}  // namespace

bool IsVideoFile(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::unique_ptr<ImageSource> OpenVideoFile(const std::string& path, const SourceOptions& options) {
  return std::make_unique<VideoFile>(path, options);
}

}  // namespace vpslam
