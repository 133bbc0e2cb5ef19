// Watches the sequence numbers of a channel, per sender, for gaps and repetitions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "core/transport/bus.h"
#include "core/transport/codec.h"

namespace vpslam {

/// More are not counted at a time, so that an alien sender can't make the count overflow.
inline constexpr int64_t kMaxMissed = 1'000'000'000;

class SequenceWatch {
 public:
  struct Verdict {
    bool is_new = true;       ///< false: repeated or overtaken
    bool new_sender = false;  ///< a session not seen before: another or a restarted process
    int64_t missed = 0;       ///< numbers left out since the last message of this sender
  };
  Verdict See(const Header& header);

 private:
  static constexpr std::size_t kMaxSenders = 64;  ///< the longest silent one is forgotten first
  struct Sender {
    int64_t session;
    int64_t last_seq;
  };
  std::deque<Sender> senders_;  // most recently heard last
};

/// Counts a refused message and logs the first ones of a channel.
void CountRejected(Bus& bus, const std::string& channel, const std::string& why);

}  // namespace vpslam
