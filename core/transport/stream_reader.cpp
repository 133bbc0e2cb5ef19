#include "core/transport/stream_reader.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/transport/ack.h"
#include "core/transport/channels.h"
#include "core/transport/publisher.h"

namespace vpslam {

class StreamReaderCore::Impl {
 public:
  Impl(Bus& bus, std::string channel, std::string consumer, AckPolicy policy)
      : bus_(bus),
        channel_(std::move(channel)),
        consumer_(std::move(consumer)),
        policy_(policy),
        acks_(bus, kAckChannel) {
    timer_ = bus.OnTick([this] { Tick(); });
  }

  // The writer needs the last acknowledgement to end as well, and nobody repeats it when this
  // process has gone: so it is said often enough here.
  ~Impl() {
    timer_.Cancel();
    if (!ended_ || done_ < next_ - 1) return;
    for (int i = 0; i < kFarewells; ++i) {
      if (i > 0) std::this_thread::sleep_for(kFarewellPause);
      Acknowledge();
    }
  }

  Verdict Receive(const Header& header) {
    const std::lock_guard lock(mutex_);
    if (!session_ || header.session != *session_) {
      if (std::find(retired_.begin(), retired_.end(), header.session) != retired_.end()) {
        return Verdict::kIgnore;
      }
      Follow(header);
    }
    if (header.oldest_seq > next_) {
      // Only a reader that the writer does not wait for can miss something for good.
      bus_.counters().gaps += std::min(header.oldest_seq - next_, kMaxMissed);
      next_ = header.oldest_seq;
      done_ = std::max(done_, next_ - 1);
    }
    if (header.seq != next_) {
      Acknowledge();  // a repetition: the acknowledgement got lost; or a gap: say what is missing
      return Verdict::kIgnore;
    }
    ++next_;
    ended_ = header.last;
    if (policy_ == AckPolicy::kOnReceipt || (ended_ && done_ == next_ - 2)) done_ = next_ - 1;
    if (ended_) farewells_left_ = kFarewells;
    Acknowledge();
    if (ended_) return Verdict::kEnd;
    return std::exchange(is_first_, false) ? Verdict::kDeliverFirstOfSession : Verdict::kDeliver;
  }

  void Done(int64_t session, int64_t seq) {
    const std::lock_guard lock(mutex_);
    if (!session_ || session != *session_ || seq >= next_ || seq <= done_) return;
    done_ = seq;
    if (ended_ && done_ == next_ - 2) done_ = next_ - 1;  // the end itself needs no work
    Acknowledge();
  }

 private:
  static constexpr int kFarewells = 6;
  static constexpr std::chrono::milliseconds kFarewellPause{5};
  static constexpr std::size_t kMaxRetired = 64;

  void Follow(const Header& header) {
    if (session_) retired_.push_back(*session_);
    if (retired_.size() > kMaxRetired) retired_.pop_front();
    session_ = header.session;
    next_ = header.oldest_seq;
    done_ = next_ - 1;
    ended_ = false;
    is_first_ = true;
  }

  void Acknowledge() {
    if (!session_) return;
    acks_.Publish({channel_, *session_, consumer_, next_ - 1, done_});
  }

  void Tick() {
    const std::lock_guard lock(mutex_);
    if (!ended_ || done_ < next_ - 1 || farewells_left_ == 0) return;
    --farewells_left_;
    Acknowledge();
  }

  Bus& bus_;
  const std::string channel_;
  const std::string consumer_;
  const AckPolicy policy_;
  Publisher<Ack> acks_;
  std::mutex mutex_;
  std::optional<int64_t> session_;
  std::deque<int64_t> retired_;  // sessions of writers that were replaced
  int64_t next_ = 0;             // sequence number that is to come
  int64_t done_ = -1;
  bool ended_ = false;
  bool is_first_ = false;  // nothing was delivered yet from this session
  int farewells_left_ = 0;
  Bus::Registration timer_;
};

StreamReaderCore::StreamReaderCore(Bus& bus, std::string channel, std::string consumer,
                                   AckPolicy policy)
    : impl_(std::make_unique<Impl>(bus, std::move(channel), std::move(consumer), policy)) {}
StreamReaderCore::~StreamReaderCore() = default;
StreamReaderCore::Verdict StreamReaderCore::Receive(const Header& header) {
  return impl_->Receive(header);
}
void StreamReaderCore::Done(int64_t session, int64_t seq) { impl_->Done(session, seq); }

}  // namespace vpslam
