#include "core/transport/sequence_watch.h"

#include <algorithm>

#include <spdlog/spdlog.h>

namespace vpslam {

SequenceWatch::Verdict SequenceWatch::See(const Header& header) {
  Verdict verdict;
  const auto found = std::find_if(senders_.begin(), senders_.end(), [&](const Sender& sender) {
    return sender.session == header.session;
  });
  if (found == senders_.end()) {
    verdict.new_sender = true;
    senders_.push_back({header.session, header.seq});
    if (senders_.size() > kMaxSenders) senders_.pop_front();
    return verdict;
  }
  Sender sender = *found;
  if (header.seq <= sender.last_seq) {
    verdict.is_new = false;
    return verdict;
  }
  verdict.missed = std::min(header.seq - sender.last_seq - 1, kMaxMissed);
  sender.last_seq = header.seq;
  senders_.erase(found);
  senders_.push_back(sender);
  return verdict;
}

void CountRejected(Bus& bus, const std::string& channel, const std::string& why) {
  constexpr int64_t kLogged = 10;
  const int64_t count = ++bus.counters().rejected;
  if (count > kLogged) return;
  spdlog::warn("refused a message on {}: {}{}", channel, why,
               count == kLogged ? " (further ones are only counted)" : "");
}

}  // namespace vpslam
