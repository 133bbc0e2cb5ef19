// Messages as bytes: what goes into a datagram and what is accepted out of one.
//
// Both directions check the same things (core/messages/validate.h), so that nothing is sent which
// a receiver would have to refuse.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/description.h"

namespace vpslam {

/// Stands at the head of every message.
struct Header {
  int64_t session = 0;     ///< one per start of the sending process
  int64_t seq = 0;         ///< counts the messages of a session on a channel, from 0
  int64_t oldest_seq = 0;  ///< reliable streams: oldest message that can still be sent again
  int64_t stamp_us = 0;    ///< CLOCK_REALTIME when it was sent first
  bool last = false;       ///< end of stream; the payload is empty

  static constexpr const char* kWireName = "header_t";
  static void Describe(auto& v, auto& m) {
    auto& [session, seq, oldest_seq, stamp_us, last] = m;
    // Sums of some sequence numbers have to fit, too.
    v("session", session);
    v("seq", seq, Between{0, int64_t{1} << 61});
    v("oldest_seq", oldest_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("last", last);
  }
  std::optional<std::string> Validate() const {
    if (oldest_seq > seq) return "oldest_seq: later than seq";
    return std::nullopt;
  }
};

template <class T>
struct Decoded {
  Header header;
  T value;  ///< default where header.last
};

/// Throws std::invalid_argument, saying what is wrong, if `value` is nothing that may be sent.
template <class T>
std::vector<uint8_t> Encode(const Header& header, const T& value);

/// nullopt for anything that is not a sound message of this type, `why` tells the reason. Never
/// throws and never allocates more than a small multiple of the datagram's size.
template <class T>
std::optional<Decoded<T>> Decode(std::span<const uint8_t> bytes, std::string* why);

/// The head of a message of any type of ours, without a look at the rest; nullopt if too short.
std::optional<Header> PeekHeader(std::span<const uint8_t> bytes);

/// Rewrites Header::oldest_seq in an encoded message, which is sent again as it is otherwise.
void SetOldestSeq(std::vector<uint8_t>* bytes, int64_t oldest_seq);

/// All messages, each with the type in lcmtypes/ that says how it travels: X(message, type).
#define VPSLAM_MESSAGES(X)         \
  X(Camera, camera_t)              \
  X(ImageMessage, image_t)         \
  X(FrameFeatures, features_t)     \
  X(LineSet, lines_t)              \
  X(LinesRequest, lines_request_t) \
  X(FramePose, pose_t)             \
  X(Truth, truth_t)                \
  X(KeyframeProposal, keyframe_t)  \
  X(MapDelta, map_delta_t)         \
  X(MapRequest, map_request_t)     \
  X(Ack, ack_t)                    \
  X(Command, command_t)            \
  X(RunDescription, run_t)         \
  X(ProcessStatus, status_t)       \
  X(Preview, preview_t)            \
  X(Outcome, outcome_t)

}  // namespace vpslam
