#include "player/video_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/camera_file.h"
#include "core/base/stopwatch.h"
#include "player/bad_frame_guard.h"
#include "player/frame_check.h"
#include "player/video_contents.h"

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
    complaints_.emplace();
    contents_ = ReadVideoContents(path);
    // Pixels as stored: a calibration belongs to the sensor, whichever way it was held.
    if (!video_.open(path, cv::CAP_ANY)) {
      throw std::runtime_error(path +
                               ": is no video that FFmpeg can read, or is truncated; name a "
                               "video file, or the folder of a sequence");
    }
    FfmpegComplaints::Listen();
    video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    const double rate_hz = video_.get(cv::CAP_PROP_FPS);
    if (rate_hz > 0 && rate_hz < 1000) camera_.fps = rate_hz;
    if (options.fps > 0) camera_.fps = options.fps;
    while (index_ < options.start && video_.grab()) ++index_;
  }

  const Camera& camera() const override { return camera_; }

  std::optional<SourceFrame> Next() override {
    cv::Mat pixels;
    for (;;) {
      if (options_.max_frames > 0 && index_ >= options_.start + options_.max_frames) return {};
      Stopwatch watch;
      if (!video_.read(pixels)) {
        ended_ = true;
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
      times_ms_.push_back(video_.get(cv::CAP_PROP_POS_MSEC));
      last_stamp_us_ = StampOf_us(index);
      return SourceFrame{last_stamp_us_, ToGrey(pixels).clone(), watch.Lap_ms()};
    }
  }

  SourceReport Report() override {
    SourceReport report;
    report.skipped = skipped_;
    const int64_t missing = ended_ ? Missing() : 0;
    if (missing > 0) report.skipped["missing or damaged in the file"] = missing;
    if (missing > 0 || (ended_ && !contents_.frames && complaints_->count() > 0)) {
      report.notes.push_back(fmt::format("{}: is truncated or damaged{}", path_, Complaint()));
    }
    const int64_t read = index_ - options_.start;
    if (ended_) {
      report.expected = read + missing;
    } else if (contents_.frames) {
      report.expected = *contents_.frames - options_.start;
    } else if (contents_.duration_s > 0) {
      report.expected = std::llround(contents_.duration_s * camera_.fps) - options_.start;
    }
    if (options_.max_frames > 0 && report.expected) {
      report.expected = std::min(*report.expected, options_.max_frames);
    }
    return report;
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

  /// Frames that the container promises, and that did not come. Where it does not count them, only
  /// what FFmpeg complains about makes a gap one where frames are missing: times may be uneven, and
  /// the sound may last longer.
  int64_t Missing() const {
    if (contents_.frames) return std::max<int64_t>(0, *contents_.frames - index_);
    if (complaints_->count() == 0 || times_ms_.size() < 2) return 0;
    std::vector<double> times_ms = times_ms_, steps_ms;
    std::sort(times_ms.begin(), times_ms.end());  // damage may bring them out of order
    for (size_t i = 1; i < times_ms.size(); ++i) steps_ms.push_back(times_ms[i] - times_ms[i - 1]);
    std::vector<double> sorted = steps_ms;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double step_ms = *middle;
    if (step_ms <= 0) return 0;
    steps_ms.push_back(1e3 * contents_.duration_s - times_ms.back());
    double missing = 0;
    for (const double ms : steps_ms) {
      if (ms > 1.5 * step_ms) missing += std::round(ms / step_ms) - 1;
    }
    return std::llround(missing);
  }

  std::string Complaint() const {
    return complaints_->count() == 0 ? std::string() : " (FFmpeg: " + complaints_->first() + ")";
  }

  void Skip(int64_t index, const std::string& fault) {
    const std::string what = fmt::format("{}: frame {} {}", path_, index, fault);
    if (const auto why = guard_.CountBad()) {
      throw std::runtime_error(what + "; " + *why +
                               "; correct the calibration or name another one with --camera");
    }
    ++skipped_["is of another size or depth"];
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
  std::optional<FfmpegComplaints> complaints_;
  VideoContents contents_;
  std::map<std::string, int64_t> skipped_;
  int64_t index_ = 0;
  std::vector<double> times_ms_;  // of the frames that were read
  bool ended_ = false;
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
