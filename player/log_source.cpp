#include "player/log_source.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "core/base/stopwatch.h"
#include "core/messages/process_status.h"
#include "core/messages/truth.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/event_log.h"
#include "core/transport/image_message.h"
#include "player/bad_frame_guard.h"
#include "player/time_order.h"
#include "player/truth_track.h"

namespace vpslam {
namespace {

/// A frame of the log, and where it is.
struct LoggedFrame {
  int64_t position = 0;
  int64_t stamp_us = 0;
};

/// What a log holds of one kind of frames, images or features.
struct LoggedFrames {
  std::vector<LoggedFrame> frames;                    // in the order of the log
  std::set<std::pair<int64_t, int64_t>> seen;         // messages: session, number
  std::set<std::pair<int64_t, int64_t>> seen_frames;  // number, stamp
  std::map<int64_t, int64_t> sent;  // by session: how many there were, as numbered
  int64_t damaged = 0;              // messages
  bool ended = false;
};

class LogSource : public ImageSource {
 public:
  LogSource(const std::string& path, const SourceOptions& options)
      : path_(path), options_(options), reader_(path) {
    LookThrough();
    if (!options.camera_file.empty()) camera_ = ReadCameraFile(options.camera_file);
    has_features_ = options.features || images_.frames.empty();
    LoggedFrames& chosen = has_features_ ? features_ : images_;
    if (chosen.frames.empty()) Fail(WhyNoFrames());
    CountTheLost(chosen);
    PutInOrderOfTime(chosen);
    TakeTheRange();
    for (const std::string& note : report_.notes) options_.tell(note);
  }

  const Camera& camera() const override { return camera_; }
  bool HasFeatures() const override { return has_features_; }

  std::optional<SourceFrame> Next() override {
    if (next_ >= frames_.size()) return std::nullopt;
    Stopwatch watch;
    const LoggedFrame& logged = frames_[next_++];
    const LogEvent event = reader_.ReadAt(logged.position);
    SourceFrame frame = has_features_ ? ReadFeatures(event) : ReadImage(event);
    frame.stamp_us = logged.stamp_us;
    frame.decode_ms = watch.Lap_ms();
    return frame;
  }

  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    const bool moved = bridged_by_us_ > 0 && stamp_us >= bridged_from_us_;
    return truth_.Nearest(stamp_us - (moved ? bridged_by_us_ : 0));
  }

  SourceReport Report() override { return report_; }

 private:
  [[noreturn]] void Fail(const std::string& why) const {
    throw std::runtime_error(path_ + ": " + why);
  }

  /// A sound message of this type.
  template <class T>
  auto Take(const LogEvent& event) -> decltype(Decode<T>(event.bytes, nullptr)) {
    std::string why;
    auto message = Decode<T>(event.bytes, &why);
    if (!message && refused_++ == 0) {
      options_.tell(fmt::format("{}: {}: {}", path_, event.channel, why));
    }
    return message;
  }

  void LookThrough() {
    EventLogReader reader(path_);
    bool has_camera = false;
    int32_t protocol = kProtocolVersion;
    while (const std::optional<LogEvent> event = reader.Next()) {
      if (event->channel == kCameraChannel) {
        const auto camera = Take<Camera>(*event);
        if (!camera || camera->header.last) continue;
        camera_ = camera->value;
        has_camera = true;
      } else if (event->channel == kTruthChannel) {
        const auto truth = Take<Truth>(*event);
        if (!truth || truth->header.last) continue;
        truth_.Add(truth->value.stamp_us, truth->value.world_from_cam);
      } else if (event->channel == kImageChannel) {
        Note(Take<ImageMessage>(*event), reader.position(), &images_);
      } else if (event->channel == kFeaturesChannel) {
        Note(Take<FrameFeatures>(*event), reader.position(), &features_);
      } else if (event->channel == kStatusChannel) {
        const auto status = Take<ProcessStatus>(*event);
        if (status) protocol = status->value.protocol_version;
      } else if (event->channel.ends_with(kImageChannel)) {
        foreign_channel_ = event->channel;
      }
    }
    if (reader.damaged_bytes() > 0) {
      report_.notes.push_back(fmt::format("{}: {} bytes in {} places are damaged and left out",
                                          path_, reader.damaged_bytes(), reader.damaged_places()));
    }
    const bool nothing = images_.frames.empty() && handles_ == 0 && features_.frames.empty();
    if (refused_ > 0 && (!has_camera || nothing)) {
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
    if (!has_camera && !foreign_channel_.empty()) {
      Fail("its channels have other names, such as " + foreign_channel_ +
           "; write them as they are in docs/protocol.md");
    }
    if (!has_camera) Fail("holds no camera; record it with `run --record features` or `all`");
  }

  /// Other loggers keep what was sent again, too, and a frontend that was started again may have
  /// published a frame twice.
  template <class Message>
  void Note(const Message& message, int64_t position, LoggedFrames* kind) {
    if (!message) {
      ++kind->damaged;
      return;
    }
    kind->ended |= message->header.last;
    if (message->header.last) return;
    const auto& frame = message->value;
    int64_t& sent = kind->sent[message->header.session];
    sent = std::max(sent, frame.frame_seq + 1);
    if (!kind->seen.insert({message->header.session, message->header.seq}).second) return;
    if (!kind->seen_frames.insert({frame.frame_seq, frame.stamp_us}).second) return;
    if constexpr (requires { frame.segment; }) {
      if (!frame.segment.empty()) {
        ++handles_;
        return;
      }
    }
    kind->frames.push_back({position, frame.stamp_us});
  }

  std::string WhyNoFrames() const {
    if (options_.features && !images_.frames.empty()) {
      return "holds no features, but images; leave out --features";
    }
    if (handles_ > 0) {
      return "its images were in shared memory and are gone; record with `run --record all`";
    }
    return "holds neither images nor features; record with `run --record features` or `all`";
  }

  /// Frames are numbered from 0 on: of the images, for each player that was heard; of the features,
  /// which several frontends may have found, for all together.
  void CountTheLost(const LoggedFrames& chosen) {
    int64_t sent = 0;
    for (const auto& [session, frames] : chosen.sent) {
      sent = has_features_ ? std::max(sent, frames) : sent + frames;
    }
    const auto there = static_cast<int64_t>(chosen.frames.size());
    const int64_t lost = std::max<int64_t>(0, sent - there);
    const int64_t damaged = std::min(lost, chosen.damaged);
    if (damaged > 0) report_.skipped["damaged in the log"] = damaged;
    if (lost > damaged) report_.skipped["missing in the log"] = lost - damaged;
    expected_ = there + lost;
    if (!chosen.ended) report_.without_end = path_ + " is cut off";
  }

  void PutInOrderOfTime(const LoggedFrames& chosen) {
    std::vector<int64_t> stamps;
    for (const LoggedFrame& frame : chosen.frames) stamps.push_back(frame.stamp_us);
    const TimeOrder time = OrderByTime(stamps);
    const size_t left_out = time.repeated.size() + time.set_aside.size();
    const auto seconds = [&](size_t i) { return 1e-6 * static_cast<double>(stamps[i]); };
    if (time.clocks > 1) {
      Fail(
          fmt::format("time goes back {} times, at image {} first: it holds the images of several "
                      "cameras or runs; write each into a log of its own",
                      time.clocks - 1, time.jump_at));
    }
    if (BadFrameGuard(std::ssize(stamps)).IsTooMany(static_cast<int64_t>(left_out))) {
      const size_t first = time.repeated.empty() ? time.set_aside[0] : time.repeated[0];
      Fail(fmt::format(
          "image {} has the time stamp {:.6f}, which {}; so it is with {} of {} images; "
          "write each camera or run into a log of its own",
          first, seconds(first), time.repeated.empty() ? "fits nowhere" : "another one has",
          left_out, stamps.size()));
    }
    if (!time.repeated.empty()) {
      report_.skipped["repeated time stamp"] = std::ssize(time.repeated);
    }
    if (!time.set_aside.empty()) {
      report_.skipped["time stamp out of place"] = std::ssize(time.set_aside);
    }
    if (time.sorted) {
      report_.notes.push_back(path_ + ": its images are not in order of time, and were sorted");
    }
    if (time.jump_us > 0) {
      bridged_from_us_ = stamps[time.jump_at] + time.jump_us;
      bridged_by_us_ = time.jump_us;
      report_.notes.push_back(fmt::format(
          "{}: the clock was set back by {:g} s at image {}; the images from there on were moved "
          "behind those before",
          path_, seconds(time.jump_at - 1) - seconds(time.jump_at), time.jump_at));
    }
    for (size_t i = 0; i < time.order.size(); ++i) {
      frames_.push_back({chosen.frames[time.order[i]].position, time.stamps_us[i]});
    }
  }

  void TakeTheRange() {
    const auto n = static_cast<int64_t>(frames_.size());
    if (options_.start >= n) {
      Fail(fmt::format("has {} frames, and --start {} leaves none; start earlier", n,
                       options_.start));
    }
    next_ = static_cast<size_t>(options_.start);
    const bool is_part = options_.max_frames > 0 && options_.max_frames < n - options_.start;
    report_.expected = expected_ - options_.start;
    if (is_part) {
      frames_.resize(static_cast<size_t>(options_.start + options_.max_frames));
      report_.expected = options_.max_frames;
      report_.skipped.clear();  // of a part of the log, what is lost elsewhere does not matter
      report_.without_end.clear();
    }
  }

  SourceFrame ReadImage(const LogEvent& event) {
    const auto message = Take<ImageMessage>(event);
    if (!message) Fail("has changed while it was read; read it again");
    const ImageMessage& image = message->value;
    if (image.width != camera_.width || image.height != camera_.height) {
      Fail(fmt::format("has an image of {} x {} px, but its camera has {} x {}", image.width,
                       image.height, camera_.width, camera_.height));
    }
    SourceFrame frame;
    frame.grey.create(image.height, image.width, CV_8UC1);
    std::memcpy(frame.grey.data, image.bytes.data(), image.bytes.size());
    return frame;
  }

  SourceFrame ReadFeatures(const LogEvent& event) {
    auto message = Take<FrameFeatures>(event);
    if (!message) Fail("has changed while it was read; read it again");
    SourceFrame frame;
    frame.features = std::make_shared<const FrameFeatures>(std::move(message->value));
    return frame;
  }

  const std::string path_;
  const SourceOptions options_;
  EventLogReader reader_;
  Camera camera_;
  TruthTrack truth_;
  bool has_features_ = false;
  LoggedFrames images_, features_;
  int64_t handles_ = 0, refused_ = 0;
  std::string foreign_channel_;  // of images under another name

  std::vector<LoggedFrame> frames_;  // to be played, in order of time
  size_t next_ = 0;
  int64_t expected_ = 0;
  int64_t bridged_from_us_ = 0, bridged_by_us_ = 0;
  SourceReport report_;
};

}  // namespace

bool IsMessageLog(const std::string& name) { return IsEventLog(name); }

std::unique_ptr<ImageSource> OpenMessageLog(const std::string& name, const SourceOptions& options) {
  return std::make_unique<LogSource>(name, options);
}

}  // namespace vpslam
