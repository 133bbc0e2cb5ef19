#include "player/log_source.h"

#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "core/base/stopwatch.h"
#include "core/messages/process_status.h"
#include "core/messages/truth.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/event_log.h"
#include "core/transport/image_message.h"
#include "core/transport/sequence_watch.h"
#include "player/truth_track.h"

namespace vpslam {
namespace {

class LogSource : public ImageSource {
 public:
  LogSource(const std::string& path, const SourceOptions& options)
      : path_(path), options_(options), reader_(path) {
    LookThrough();
    if (!options.camera_file.empty()) camera_ = ReadCameraFile(options.camera_file);
    has_features_ = options.features || images_ == 0;
    const int64_t frames = has_features_ ? features_ : images_;
    if (frames == 0) Fail(WhyNoFrames());
    if (options.start >= frames) {
      Fail(fmt::format("has {} frames, and --start {} leaves none; start earlier", frames,
                       options.start));
    }
  }

  const Camera& camera() const override { return camera_; }
  bool HasFeatures() const override { return has_features_; }

  std::optional<SourceFrame> Next() override {
    if (options_.max_frames > 0 && delivered_ >= options_.max_frames) return std::nullopt;
    Stopwatch watch;
    while (std::optional<LogEvent> event = reader_.Next()) {
      std::optional<SourceFrame> frame = has_features_ ? ReadFeatures(*event) : ReadImage(*event);
      // A frontend that was started again may have published a frame twice.
      if (!frame || frame->stamp_us <= last_us_) continue;
      last_us_ = frame->stamp_us;
      if (passed_++ < options_.start) continue;
      frame->decode_ms = watch.Lap_ms();
      ++delivered_;
      return frame;
    }
    return std::nullopt;
  }

  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    return truth_.Nearest(stamp_us);
  }

  std::string Summary() override {
    return refused_ == 0 ? std::string()
                         : fmt::format("{}: left out {} damaged messages", path_, refused_);
  }

 private:
  [[noreturn]] void Fail(const std::string& why) const {
    throw std::runtime_error(path_ + ": " + why);
  }

  /// A sound message of this type, the first time that it comes.
  template <class T>
  std::optional<T> Take(const LogEvent& event, const char* channel, SequenceWatch* watch) {
    if (event.channel != channel) return std::nullopt;
    std::string why;
    auto message = Decode<T>(event.bytes, &why);
    if (!message) {
      if (refused_++ == 0) options_.tell(fmt::format("{}: {}: {}", path_, channel, why));
      return std::nullopt;
    }
    // Other loggers keep what was sent again, too.
    if (message->header.last || !watch->See(message->header).is_new) return std::nullopt;
    return std::move(message->value);
  }

  void LookThrough() {
    EventLogReader reader(path_);
    bool has_camera = false;
    SequenceWatch cameras, truths, images, features, statuses;
    int32_t protocol = kProtocolVersion;
    while (const std::optional<LogEvent> event = reader.Next()) {
      if (const auto camera = Take<Camera>(*event, kCameraChannel, &cameras)) {
        camera_ = *camera;
        has_camera = true;
      } else if (const auto truth = Take<Truth>(*event, kTruthChannel, &truths)) {
        truth_.Add(truth->stamp_us, truth->world_from_cam);
      } else if (event->channel == kImageChannel) {
        const auto image = Take<ImageMessage>(*event, kImageChannel, &images);
        if (image) ++(image->segment.empty() ? images_ : handles_);
      } else if (Take<FrameFeatures>(*event, kFeaturesChannel, &features)) {
        ++features_;
      } else if (const auto status = Take<ProcessStatus>(*event, kStatusChannel, &statuses)) {
        protocol = status->protocol_version;
      }
    }
    if (reader.damaged_bytes() > 0) {
      options_.tell(
          fmt::format("{}: {} bytes are damaged and left out", path_, reader.damaged_bytes()));
    }
    if (refused_ > 0 && (!has_camera || images_ + handles_ + features_ == 0)) {
      if (protocol != kProtocolVersion) {
        Fail(
            fmt::format("was recorded with version {} of the protocol, and this program reads {}; "
                        "replay it with the version that recorded it",
                        protocol, kProtocolVersion));
      }
      Fail(
          "its messages are damaged or of another version of the protocol; replay it with the "
          "version that recorded it");
    }
    refused_ = 0;
    if (!has_camera) Fail("holds no camera; record it with `run --record features` or `all`");
  }

  std::string WhyNoFrames() const {
    if (options_.features && images_ > 0) {
      return "holds no features, but images; leave out --features";
    }
    if (handles_ > 0) {
      return "its images were in shared memory and are gone; record with `run --record all`";
    }
    return "holds neither images nor features; record with `run --record features` or `all`";
  }

  std::optional<SourceFrame> ReadImage(const LogEvent& event) {
    auto image = Take<ImageMessage>(event, kImageChannel, &watch_);
    if (!image || !image->segment.empty()) return std::nullopt;
    if (image->width != camera_.width || image->height != camera_.height) {
      Fail(fmt::format("has an image of {} x {} px, but its camera has {} x {}", image->width,
                       image->height, camera_.width, camera_.height));
    }
    SourceFrame frame;
    frame.stamp_us = image->stamp_us;
    frame.grey.create(image->height, image->width, CV_8UC1);
    std::memcpy(frame.grey.data, image->bytes.data(), image->bytes.size());
    return frame;
  }

  std::optional<SourceFrame> ReadFeatures(const LogEvent& event) {
    auto features = Take<FrameFeatures>(event, kFeaturesChannel, &watch_);
    if (!features) return std::nullopt;
    SourceFrame frame;
    frame.stamp_us = features->stamp_us;
    frame.features = std::make_shared<const FrameFeatures>(*std::move(features));
    return frame;
  }

  const std::string path_;
  const SourceOptions options_;
  EventLogReader reader_;
  SequenceWatch watch_;
  Camera camera_;
  TruthTrack truth_;
  bool has_features_ = false;
  int64_t images_ = 0, handles_ = 0, features_ = 0;
  int64_t last_us_ = std::numeric_limits<int64_t>::min();
  int64_t passed_ = 0, delivered_ = 0, refused_ = 0;
};

}  // namespace

bool IsMessageLog(const std::string& name) { return IsEventLog(name); }

std::unique_ptr<ImageSource> OpenMessageLog(const std::string& name, const SourceOptions& options) {
  return std::make_unique<LogSource>(name, options);
}

}  // namespace vpslam
