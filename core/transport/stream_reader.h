// The receiving end of a reliable stream: in order, each message once, with its end.
//
// A reader takes up a stream at the oldest message that its writer can still send again. When the
// writer is a new process (a new session), the reader follows that one from then on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/transport/bus.h"
#include "core/transport/codec.h"
#include "core/transport/sequence_watch.h"

namespace vpslam {

enum class AckPolicy {
  kOnReceipt,  ///< acknowledged by the receive thread as soon as it is in the queue
  kWhenDone,   ///< acknowledged by Done
};

/// What does not depend on the type of the message: order, repetitions, acknowledgements.
class StreamReaderCore {
 public:
  StreamReaderCore(Bus& bus, std::string channel, std::string consumer, AckPolicy policy);
  ~StreamReaderCore();

  enum class Verdict { kDeliver, kDeliverFirstOfSession, kEnd, kIgnore };
  Verdict Receive(const Header& header);
  void Done(int64_t session, int64_t seq);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

template <class T>
class StreamReader {
 public:
  static constexpr std::size_t kUnbounded = 0;
  /// Sees each message of the stream as it travelled and what it says, in order and once, with its
  /// end. False: it is not to be queued. Called on the receive thread.
  using Tap = std::function<bool(const Decoded<T>&, std::span<const uint8_t>)>;

  /// `consumer` is the name by which the writer waits for this process. A queue that holds more
  /// than `capacity` messages drops its oldest, counted: for streams whose writer never waits.
  StreamReader(Bus& bus, const std::string& channel, const std::string& consumer, AckPolicy policy,
               std::size_t capacity = kUnbounded, Tap tap = {})
      : bus_(bus),
        channel_(channel),
        capacity_(capacity),
        core_(bus, channel, consumer, policy),
        tap_(std::move(tap)) {
    registration_ = bus.Subscribe(channel, [this](std::span<const uint8_t> b) { Receive(b); });
  }
  StreamReader(Bus& bus, const std::string& channel, const std::string& consumer, AckPolicy policy,
               Tap tap)
      : StreamReader(bus, channel, consumer, policy, kUnbounded, std::move(tap)) {}

  struct Item {
    T value;
    Header header;
    /// The first message of another session than before: the writer was restarted.
    bool restarted = false;
  };

  std::optional<Item> TryTake() {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return std::nullopt;
    std::optional<Item> item = std::move(queue_.front());
    queue_.pop_front();
    return item;
  }
  bool HasMessage() const { return size() > 0; }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return queue_.size();
  }
  /// The end of the stream was reached and everything before it was taken.
  bool Ended() const {
    const std::lock_guard lock(mutex_);
    return ended_ && queue_.empty();
  }
  /// HasMessage() or Ended(): what a worker waits for.
  bool HasNews() const {
    const std::lock_guard lock(mutex_);
    return ended_ || !queue_.empty();
  }
  /// With kWhenDone: this item and all before it need not be kept any more.
  void Done(const Header& header) { core_.Done(header.session, header.seq); }

 private:
  void Receive(std::span<const uint8_t> bytes) {
    std::string why;
    std::optional<Decoded<T>> message = Decode<T>(bytes, &why);
    if (!message) {
      CountRejected(bus_, channel_, why);
      return;
    }
    using Verdict = StreamReaderCore::Verdict;
    const std::lock_guard lock(mutex_);
    const Verdict verdict = core_.Receive(message->header);
    if (verdict == Verdict::kIgnore) return;
    ended_ = verdict == Verdict::kEnd;
    const bool wanted = !tap_ || tap_(*message, bytes);
    if (ended_ || !wanted) return;
    const bool first = verdict == Verdict::kDeliverFirstOfSession;
    queue_.push_back({std::move(message->value), message->header, first && seen_any_});
    seen_any_ = true;
    if (capacity_ == kUnbounded || queue_.size() <= capacity_) return;
    const bool restarted = queue_.front().restarted;
    queue_.pop_front();
    queue_.front().restarted |= restarted;
    ++bus_.counters().dropped;
  }

  Bus& bus_;
  const std::string channel_;
  const std::size_t capacity_;
  StreamReaderCore core_;
  const Tap tap_;
  mutable std::mutex mutex_;
  std::deque<Item> queue_;
  bool ended_ = false;
  bool seen_any_ = false;
  Bus::Registration registration_;  // last: its end stops Receive before the rest goes
};

}  // namespace vpslam
