#include "core/transport/stream_writer.h"

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>

#include <fmt/format.h>

#include "core/transport/ack.h"
#include "core/transport/channels.h"
#include "core/transport/sequence_watch.h"

namespace vpslam {
namespace {
using Clock = std::chrono::steady_clock;
constexpr std::chrono::hours kForever{24 * 365};
}  // namespace

std::optional<std::string> StreamWriterOptions::Validate() const {
  if (window < 1) return "the window of a stream must be >= 1";
  if (first_resend.count() <= 0 || max_resend < first_resend) {
    return "the intervals of sending again must be > 0 and not shrink";
  }
  if (peer_timeout <= max_resend) return "a peer needs more time to answer than one repetition";
  return std::nullopt;
}

class StreamWriterCore::Impl {
 public:
  Impl(Bus& bus, std::string channel, std::vector<std::string> consumers,
       const StreamWriterOptions& options)
      : bus_(bus),
        channel_(std::move(channel)),
        options_(options),
        session_(options.session != 0 ? options.session : bus.session()),
        resend_interval_(options.first_resend) {
    if (const auto why = options.Validate()) throw std::invalid_argument(*why);
    for (std::string& name : consumers) consumers_.emplace(std::move(name), Consumer{});
    if (consumers_.empty()) return;
    ack_registration_ =
        bus.Subscribe(kAckChannel, [this](std::span<const uint8_t> bytes) { OnAck(bytes); });
    timer_ = bus.OnTick([this] { Tick(); });
  }

  bool WaitForRoom() {
    return bus_.WaitFor([this] { return HasRoom(); }, kForever);
  }

  bool HasRoom() const {
    const std::lock_guard lock(mutex_);
    if (options_.drop_oldest) return true;
    if (!gone_.empty()) throw PeerGoneError(gone_);
    return static_cast<int>(pending_.size()) < options_.window;
  }

  bool Send(const Encoder& encoder, bool last) {
    if (!WaitForRoom()) return false;
    const std::lock_guard lock(mutex_);
    while (options_.drop_oldest && static_cast<int>(pending_.size()) >= options_.window) {
      pending_.pop_front();
    }
    Header header;
    header.session = session_;
    header.seq = next_seq_;
    header.oldest_seq = pending_.empty() ? next_seq_ : pending_.front().seq;
    header.stamp_us = RealtimeMicroseconds();
    header.last = last;
    std::vector<uint8_t> bytes = encoder(header);
    bus_.Publish(channel_, bytes);
    ++next_seq_;
    if (consumers_.empty()) return true;
    const Clock::time_point now = Clock::now();
    if (pending_.empty()) RestartResend(now);
    pending_.push_back({header.seq, std::move(bytes), now});
    return true;
  }

  bool WaitAllAcked(std::chrono::milliseconds timeout) {
    const bool all = bus_.WaitFor(
        [this] {
          const std::lock_guard lock(mutex_);
          return !gone_.empty() || pending_.empty();
        },
        timeout);
    ThrowIfGone();
    return all;
  }

  int64_t next_seq() const {
    const std::lock_guard lock(mutex_);
    return next_seq_;
  }

  int64_t acked() const {
    const std::lock_guard lock(mutex_);
    return (pending_.empty() ? next_seq_ : pending_.front().seq) - 1;
  }

 private:
  struct Consumer {
    int64_t received = -1;
    int64_t done = -1;
    Clock::time_point heard{};
  };
  struct Pending {
    int64_t seq;
    std::vector<uint8_t> bytes;
    Clock::time_point sent;  // first
  };

  void ThrowIfGone() const {
    const std::lock_guard lock(mutex_);
    if (!gone_.empty()) throw PeerGoneError(gone_);
  }

  void RestartResend(Clock::time_point now) {
    resend_interval_ = options_.first_resend;
    next_resend_ = now + resend_interval_;
  }

  void OnAck(std::span<const uint8_t> bytes) {
    std::string why;
    const std::optional<Decoded<Ack>> ack = Decode<Ack>(bytes, &why);
    if (!ack) {
      CountRejected(bus_, kAckChannel, why);
      return;
    }
    const Ack& a = ack->value;
    const std::lock_guard lock(mutex_);
    if (a.stream != channel_ || a.stream_session != session_ || a.received >= next_seq_) return;
    const auto found = consumers_.find(a.consumer);
    if (found == consumers_.end()) return;
    Consumer& consumer = found->second;
    const Clock::time_point now = Clock::now();
    consumer.heard = now;
    if (a.received > consumer.received || a.done > consumer.done) RestartResend(now);
    // A consumer that was restarted has received less than the one before it had.
    consumer.done = std::max(consumer.done, a.done);
    consumer.received = std::max(consumer.done, a.received);
    int64_t done_by_all = consumer.done;
    for (const auto& [name, other] : consumers_) done_by_all = std::min(done_by_all, other.done);
    while (!pending_.empty() && pending_.front().seq <= done_by_all) pending_.pop_front();
  }

  void Tick() {
    const Clock::time_point now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (pending_.empty() || !gone_.empty()) return;
    for (const auto& [name, consumer] : consumers_) {
      if (consumer.done >= pending_.back().seq) continue;
      if (now - std::max(consumer.heard, pending_.front().sent) > options_.peer_timeout) {
        gone_ = fmt::format(
            "{} has not acknowledged {} message {} for {} s; is it running?", name, channel_,
            consumer.received + 1,
            std::chrono::duration_cast<std::chrono::seconds>(options_.peer_timeout).count());
        bus_.Notify();
        return;
      }
    }
    if (now < next_resend_) return;
    resend_interval_ = std::min(2 * resend_interval_, options_.max_resend);
    next_resend_ = now + resend_interval_;
    int64_t received_by_all = pending_.back().seq;
    for (const auto& [name, consumer] : consumers_) {
      received_by_all = std::min(received_by_all, consumer.received);
    }
    // Where everything was received and only Done is missing, the oldest message asks for it.
    const bool ask_only = received_by_all == pending_.back().seq;
    for (Pending& message : pending_) {
      if (!ask_only && message.seq <= received_by_all) continue;
      SetOldestSeq(&message.bytes, pending_.front().seq);
      bus_.Publish(channel_, message.bytes);
      ++bus_.counters().resent;
      if (ask_only) break;
    }
  }

  Bus& bus_;
  const std::string channel_;
  const StreamWriterOptions options_;
  const int64_t session_;
  mutable std::mutex mutex_;
  std::map<std::string, Consumer> consumers_;
  std::deque<Pending> pending_;
  int64_t next_seq_ = 0;
  std::chrono::milliseconds resend_interval_;
  Clock::time_point next_resend_;
  std::string gone_;
  Bus::Registration ack_registration_;  // last two: they end before what they use
  Bus::Registration timer_;
};

StreamWriterCore::StreamWriterCore(Bus& bus, std::string channel,
                                   std::vector<std::string> consumers,
                                   const StreamWriterOptions& options)
    : impl_(std::make_unique<Impl>(bus, std::move(channel), std::move(consumers), options)) {}
StreamWriterCore::~StreamWriterCore() = default;
bool StreamWriterCore::WaitForRoom() { return impl_->WaitForRoom(); }
bool StreamWriterCore::HasRoom() const { return impl_->HasRoom(); }
bool StreamWriterCore::Send(const Encoder& encoder, bool last) {
  return impl_->Send(encoder, last);
}
bool StreamWriterCore::WaitAllAcked(std::chrono::milliseconds timeout) {
  return impl_->WaitAllAcked(timeout);
}
int64_t StreamWriterCore::next_seq() const { return impl_->next_seq(); }
int64_t StreamWriterCore::acked() const { return impl_->acked(); }

}  // namespace vpslam
