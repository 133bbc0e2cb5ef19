#include "frontend/line_source.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/messages/process_status.h"
#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "core/transport/codec.h"
#include "core/transport/sequence_watch.h"

namespace vpslam {

LineSourceOptions LineSourceOptions::ForPace(Pace pace) {
  LineSourceOptions options;
  if (pace == Pace::kRealtime) {
    options.dispatch.keep_all = false;
    options.dispatch.max_in_hand = 1;
    options.joiner.wait_for_all = false;
  }
  return options;
}

LineSource::LineSource(Bus& bus, Peers& peers, const LineSourceOptions& options)
    : bus_(bus),
      peers_(peers),
      options_(options.joiner),
      dispatch_(options.dispatch),
      joiner_(options.joiner),
      requests_(bus, kLinesRequestChannel) {
  statuses_ = bus.Subscribe(kStatusChannel, [this](std::span<const uint8_t> b) { OnStatus(b); });
  lines_ = bus.Subscribe(kLinesChannel, [this](std::span<const uint8_t> b) { OnLines(b); });
  timer_ = bus.OnTick([this] {
    const std::lock_guard lock(mutex_);
    AskLocked();
  });
}

std::optional<LineSet> LineSource::WaitFor(const ImageFrame& image) {
  const auto decided = [&] { return Look(image) != LineJoiner::Verdict::kWait; };
  if (options_.wait_for_all) {
    if (!peers_.WaitFor(decided, {kDetector})) return std::nullopt;
  } else {
    const double waited_ms =
        1e-3 * static_cast<double>(MonotonicMicroseconds() - image.published_us);
    const double left_ms = std::max(0.0, options_.deadline_ms - waited_ms);
    bus_.WaitFor(decided, std::chrono::milliseconds(static_cast<int64_t>(std::ceil(left_ms))));
  }
  const std::lock_guard lock(mutex_);
  dispatch_.Pass(image.frame_seq);
  return joiner_.Take(image.frame_seq, image.stamp_us);
}

void LineSource::Restart() {
  const std::lock_guard lock(mutex_);
  joiner_.Restart();
}

LineJoiner::Verdict LineSource::Look(const ImageFrame& image) {
  const std::lock_guard lock(mutex_);
  if (joiner_.DropAlien(image.frame_seq, image.stamp_us)) {
    dispatch_.AskAgain(image.frame_seq);
    AskLocked();
  }
  return joiner_.Look(image.frame_seq, image.stamp_us, image.published_us, MonotonicMicroseconds());
}

void LineSource::AddImage(int64_t session, int64_t frame_seq) {
  const std::lock_guard lock(mutex_);
  dispatch_.AddImage(session, frame_seq);
  AskLocked();
}

// What does not decode is counted by Peers.
void LineSource::OnStatus(std::span<const uint8_t> bytes) {
  std::string why;
  const auto message = Decode<ProcessStatus>(bytes, &why);
  if (!message || message->value.process != kDetector) return;
  const ProcessState state = message->value.state;
  const std::lock_guard lock(mutex_);
  if (state == ProcessState::kFinished || state == ProcessState::kFailed) {
    dispatch_.RemoveDetector(message->header.session);
  } else if (state != ProcessState::kStarting) {
    dispatch_.AddDetector(message->header.session, message->value.queued, Clock::now());
  }
  AskLocked();
}

void LineSource::OnLines(std::span<const uint8_t> bytes) {
  std::string why;
  auto message = Decode<LineSet>(bytes, &why);
  if (!message) {
    CountRejected(bus_, kLinesChannel, why);
    return;
  }
  if (message->header.last) return;
  const std::lock_guard lock(mutex_);
  dispatch_.AddAnswer(message->header.session, message->value.frame_seq, Clock::now());
  joiner_.Add(std::move(message->value));
  AskLocked();
}

void LineSource::AskLocked() {
  for (const LinesRequest& request : dispatch_.Requests(Clock::now())) requests_.Publish(request);
}

}  // namespace vpslam
