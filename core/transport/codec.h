// Messages as bytes: what goes into a datagram and what is accepted out of one.
//
// Both directions check the same things (core/transport/validate.h), so that nothing is sent which
// a receiver would have to refuse.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpslam {

/// Stands at the head of every message.
struct Header {
  int64_t session = 0;     ///< one per start of the sending process
  int64_t seq = 0;         ///< counts the messages of a session on a channel, from 0
  int64_t oldest_seq = 0;  ///< reliable streams: oldest message that can still be sent again
  int64_t stamp_us = 0;    ///< CLOCK_REALTIME when it was sent first
  bool last = false;       ///< end of stream; the payload is empty
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

// Encode and Decode exist for: Camera, ImageMessage, FrameFeatures, LineSet, LinesRequest,
// FramePose, Truth, KeyframeProposal, MapDelta, MapRequest, Ack, Command, RunDescription,
// ProcessStatus, Preview.

}  // namespace vpslam
