#include "vpdetector/detector_process.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/messages/command.h"
#include "core/messages/lines_request.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/sequence_watch.h"
#include "core/transport/stream_writer.h"

namespace vpslam {
namespace {

constexpr const char* kPlayer = "player";
constexpr std::chrono::milliseconds kLookAround{500};

template <class T>
std::optional<Decoded<T>> DecodeOrCount(Bus& bus, const char* channel,
                                        std::span<const uint8_t> bytes) {
  std::string why;
  std::optional<Decoded<T>> message = Decode<T>(bytes, &why);
  if (!message) CountRejected(bus, channel, why);
  return message;
}

}  // namespace

DetectorProcess::DetectorProcess(Bus& bus, Peers& peers, StatusReporter& status,
                                 const DetectorOptions& options)
    : bus_(bus),
      peers_(peers),
      status_(status),
      options_(options),
      camera_(bus),
      answers_(bus, kLinesChannel) {
  image_registration_ =
      bus.Subscribe(kImageChannel, [this](std::span<const uint8_t> b) { OnImage(b); });
  request_registration_ =
      bus.Subscribe(kLinesRequestChannel, [this](std::span<const uint8_t> b) { OnRequest(b); });
  command_registration_ =
      bus.Subscribe(kCommandChannel, [this](std::span<const uint8_t> b) { OnCommand(b); });
}

void DetectorProcess::Run() {
  status_.SetState(ProcessState::kReady);
  const std::optional<Camera> camera = camera_.Wait(peers_);
  if (!camera) return;
  const Detector detector(*camera, options_);
  status_.SetState(ProcessState::kRunning);
  while (true) {
    bus_.WaitFor([this] { return HasWork() || SequenceIsOver(); }, kLookAround);
    if (bus_.interrupted()) return;
    if (const std::optional<ImageMessage> message = NextWork()) {
      Work(detector, *message);
    } else if (SequenceIsOver()) {
      spdlog::info("end of the sequence; answered {} images", status_.Snapshot().processed);
      return;
    } else if (const auto why = peers_.WhyGone(kPlayer)) {
      throw PeerGoneError(*why);
    }
  }
}

void DetectorProcess::OnImage(std::span<const uint8_t> bytes) {
  auto message = DecodeOrCount<ImageMessage>(bus_, kImageChannel, bytes);
  if (!message) return;
  const std::lock_guard lock(mutex_);
  if (message->header.last) {
    ended_ = true;
    return;
  }
  if (message->header.session != image_session_) {
    image_session_ = message->header.session;
    images_.clear();
    std::erase_if(wanted_, [this](const Wanted& w) { return w.image_session != image_session_; });
  }
  images_.try_emplace(message->value.frame_seq, std::move(message->value));
  if (images_.size() <= kKeptImages) return;
  images_.erase(images_.begin());
  // What was not there in time is needed no more.
  std::erase_if(wanted_, [this](const Wanted& w) {
    return w.image_session == image_session_ && w.frame_seq < images_.begin()->first;
  });
}

void DetectorProcess::OnRequest(std::span<const uint8_t> bytes) {
  const auto message = DecodeOrCount<LinesRequest>(bus_, kLinesRequestChannel, bytes);
  if (!message || message->header.last) return;
  const LinesRequest& request = message->value;
  if (request.detector != bus_.session()) return;
  const Wanted wanted{request.image_session, request.frame_seq};
  const std::lock_guard lock(mutex_);
  if (in_work_ == wanted || std::find(wanted_.begin(), wanted_.end(), wanted) != wanted_.end()) {
    return;
  }
  wanted_.push_back(wanted);
  if (wanted_.size() > kMaxWanted) wanted_.pop_front();
  status_.SetQueued(static_cast<int64_t>(wanted_.size()) + (in_work_ ? 1 : 0));
}

void DetectorProcess::OnCommand(std::span<const uint8_t> bytes) {
  const auto message = DecodeOrCount<Command>(bus_, kCommandChannel, bytes);
  if (!message || message->header.last) return;
  const Command& command = message->value;
  if (command.action != CommandAction::kStop || command.target != kName) return;
  spdlog::info("stopping (command)");
  bus_.Interrupt();
}

bool DetectorProcess::IsHere(const Wanted& wanted) const {
  return wanted.image_session == image_session_ && images_.contains(wanted.frame_seq);
}

bool DetectorProcess::HasWork() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(wanted_.begin(), wanted_.end(), [this](const Wanted& w) { return IsHere(w); });
}

// The player's last word stands in for an end of the stream that got lost.
bool DetectorProcess::SequenceIsOver() const {
  if (const auto player = peers_.Get(kPlayer);
      player &&
      (player->state == ProcessState::kFinished || player->state == ProcessState::kFailed)) {
    return true;
  }
  const std::lock_guard lock(mutex_);
  return ended_;
}

std::optional<ImageMessage> DetectorProcess::NextWork() {
  const std::lock_guard lock(mutex_);
  in_work_.reset();
  const auto next =
      std::find_if(wanted_.begin(), wanted_.end(), [this](const Wanted& w) { return IsHere(w); });
  if (next == wanted_.end()) {
    status_.SetQueued(static_cast<int64_t>(wanted_.size()));
    return std::nullopt;
  }
  in_work_ = *next;
  wanted_.erase(next);
  status_.SetQueued(static_cast<int64_t>(wanted_.size()) + 1);
  return images_.at(in_work_->frame_seq);
}

void DetectorProcess::Work(const Detector& detector, const ImageMessage& message) {
  std::string why;
  const std::optional<ImageFrame> image = fetcher_.Fetch(message, &why);
  if (!image) {
    // Its slot was used again, so nobody waits for it any more; or shared memory is out of reach.
    CountRejected(bus_, kImageChannel, why);
    if (++unreadable_ < kMaxUnreadable) return;
    throw std::runtime_error(fmt::format(
        "{} images could not be read one after the other: {}; on another host than the player's, "
        "play with --inline",
        unreadable_, why));
  }
  unreadable_ = 0;
  LineSet lines;
  try {
    lines = detector.Detect(image->pixels);
  } catch (const std::exception& e) {
    spdlog::warn("frame {}: {}; it gets no lines", image->frame_seq, e.what());
    lines = LineSet();
  }
  lines.frame_seq = image->frame_seq;
  lines.stamp_us = image->stamp_us;
  Answer(std::move(lines));
  status_.AddProcessed();
}

// Every image is answered, with an empty message if need be: somebody waits.
void DetectorProcess::Answer(LineSet lines) {
  try {
    answers_.Publish(lines);
  } catch (const std::invalid_argument& e) {
    spdlog::warn("frame {}: {}; it gets no lines", lines.frame_seq, e.what());
    LineSet empty;
    empty.frame_seq = lines.frame_seq;
    empty.stamp_us = lines.stamp_us;
    answers_.Publish(empty);
  }
}

}  // namespace vpslam
