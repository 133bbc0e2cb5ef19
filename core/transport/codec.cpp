#include "core/transport/codec.h"

#include <array>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "core/transport/convert.h"

namespace vpslam {
namespace {

// Layout of the head of every message: fingerprint, header_t, then the lengths of the arrays.
constexpr std::size_t kFingerprintBytes = 8;
constexpr std::size_t kOldestSeqOffset = kFingerprintBytes + 16;
constexpr std::size_t kHeaderBytes = 33;
constexpr std::size_t kLengthsOffset = kFingerprintBytes + kHeaderBytes;

constexpr int64_t kKeypointBytes = 24;
constexpr int64_t kDescriptorBytes = 32;
constexpr int64_t kLineBytes = 53;
constexpr int64_t kVanishingPointBytes = 60;

// Per message: lcm-gen's type, and for each of its lengths, in order, the bytes that one element
// takes in the datagram.
template <class T>
struct Wire;
template <>
struct Wire<Camera> {
  using Type = camera_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<ImageMessage> {
  using Type = image_t;
  static constexpr std::array<int64_t, 1> kElementBytes{1};
};
template <>
struct Wire<FrameFeatures> {
  using Type = features_t;
  static constexpr std::array<int64_t, 3> kElementBytes{kKeypointBytes + kDescriptorBytes,
                                                        kLineBytes, kVanishingPointBytes};
};
template <>
struct Wire<LineSet> {
  using Type = lines_t;
  static constexpr std::array<int64_t, 2> kElementBytes{kLineBytes, kVanishingPointBytes};
};
template <>
struct Wire<LinesRequest> {
  using Type = lines_request_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<FramePose> {
  using Type = pose_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<Truth> {
  using Type = truth_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<KeyframeProposal> {
  using Type = keyframe_t;
  // features and lines (each with the id of a map point or line), sightings, initial points, ...
  static constexpr std::array<int64_t, 6> kElementBytes{
      kKeypointBytes + kDescriptorBytes + 4, 12, 32, kLineBytes + 4, kVanishingPointBytes, 8};
};
template <>
struct Wire<MapDelta> {
  using Type = map_delta_t;
  // erased maps, merged maps, keyframes, observations, appearances, geometries, tombstones,
  // observations of lines, lines, their tombstones, Manhattan frames
  static constexpr std::array<int64_t, 11> kElementBytes{4, 8, 157, 8, 44, 32, 8, 8, 72, 8, 37};
};
template <>
struct Wire<MapRequest> {
  using Type = map_request_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<Ack> {
  using Type = ack_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<Command> {
  using Type = command_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<RunDescription> {
  using Type = run_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<ProcessStatus> {
  using Type = status_t;
  static constexpr std::array<int64_t, 0> kElementBytes{};
};
template <>
struct Wire<Preview> {
  using Type = preview_t;
  static constexpr std::array<int64_t, 1> kElementBytes{1};
};

template <class Integer>
Integer ReadBigEndian(std::span<const uint8_t> bytes, std::size_t offset) {
  uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) value = value << 8 | bytes[offset + i];
  return static_cast<Integer>(value);
}

// lcm-gen's decode resizes vectors to whatever a length says before it looks whether so much was
// sent, and throws for negative ones.
template <class T>
bool LengthsFit(std::span<const uint8_t> bytes, std::string* why) {
  const auto& element_bytes = Wire<T>::kElementBytes;
  const std::size_t body_offset = kLengthsOffset + 4 * element_bytes.size();
  if (bytes.size() < body_offset) {
    *why = "truncated";
    return false;
  }
  int64_t needed = static_cast<int64_t>(body_offset);
  for (std::size_t i = 0; i < element_bytes.size(); ++i) {
    const int64_t length = ReadBigEndian<int32_t>(bytes, kLengthsOffset + 4 * i);
    if (length < 0) {
      *why = "negative length of an array";
      return false;
    }
    needed += length * element_bytes[i];
  }
  if (needed > static_cast<int64_t>(bytes.size())) {
    *why = "an array is longer than the message";
    return false;
  }
  return true;
}

}  // namespace

template <class T>
std::vector<uint8_t> Encode(const Header& header, const T& value) {
  if (const Fault fault = Validate(header)) throw std::invalid_argument("header: " + *fault);
  typename Wire<T>::Type wire{};
  if (!header.last) {
    if (const Fault fault = Validate(value)) {
      throw std::invalid_argument(std::string(wire.getTypeName()) + " cannot be sent: " + *fault);
    }
    wire = ToWire(value);
  }
  wire.header.session = header.session;
  wire.header.seq = header.seq;
  wire.header.oldest_seq = header.oldest_seq;
  wire.header.stamp_us = header.stamp_us;
  wire.header.last = header.last;
  std::vector<uint8_t> bytes(wire.getEncodedSize());
  if (wire.encode(bytes.data(), 0, static_cast<int>(bytes.size())) !=
      static_cast<int>(bytes.size())) {
    throw std::invalid_argument(std::string(wire.getTypeName()) + " cannot be encoded");
  }
  return bytes;
}

template <class T>
std::optional<Decoded<T>> Decode(std::span<const uint8_t> bytes, std::string* why) try {
  using Type = typename Wire<T>::Type;
  if (bytes.size() < kLengthsOffset) {
    *why = "truncated";
    return std::nullopt;
  }
  if (ReadBigEndian<int64_t>(bytes, 0) != Type::getHash()) {
    *why = "another type of message, or another version of it";
    return std::nullopt;
  }
  if (!LengthsFit<T>(bytes, why)) return std::nullopt;
  Type wire{};
  const int size = static_cast<int>(bytes.size());
  if (wire.decode(bytes.data(), 0, size) != size) {
    *why = "length does not fit the content";
    return std::nullopt;
  }
  Decoded<T> decoded;
  decoded.header.session = wire.header.session;
  decoded.header.seq = wire.header.seq;
  decoded.header.oldest_seq = wire.header.oldest_seq;
  decoded.header.stamp_us = wire.header.stamp_us;
  decoded.header.last = wire.header.last != 0;
  if (Fault fault = Validate(decoded.header)) {
    *why = *std::move(fault);
    return std::nullopt;
  }
  if (decoded.header.last) return decoded;
  std::optional<T> value = FromWire(wire, why);
  if (!value) return std::nullopt;
  decoded.value = *std::move(value);
  return decoded;
} catch (const std::exception&) {
  *why = "a string of impossible length";  // the one throw that LengthsFit does not prevent
  return std::nullopt;
}

std::optional<Header> PeekHeader(std::span<const uint8_t> bytes) {
  if (bytes.size() < kLengthsOffset) return std::nullopt;
  Header header;
  header.session = ReadBigEndian<int64_t>(bytes, kFingerprintBytes);
  header.seq = ReadBigEndian<int64_t>(bytes, kFingerprintBytes + 8);
  header.oldest_seq = ReadBigEndian<int64_t>(bytes, kOldestSeqOffset);
  header.stamp_us = ReadBigEndian<int64_t>(bytes, kFingerprintBytes + 24);
  header.last = bytes[kFingerprintBytes + 32] != 0;
  return header;
}

void SetOldestSeq(std::vector<uint8_t>* bytes, int64_t oldest_seq) {
  const auto value = static_cast<uint64_t>(oldest_seq);
  for (int i = 0; i < 8; ++i) {
    (*bytes)[kOldestSeqOffset + i] = static_cast<uint8_t>(value >> (56 - 8 * i));
  }
}

#define VPSLAM_INSTANTIATE(T)                                    \
  template std::vector<uint8_t> Encode(const Header&, const T&); \
  template std::optional<Decoded<T>> Decode<T>(std::span<const uint8_t>, std::string*);
VPSLAM_INSTANTIATE(Camera)
VPSLAM_INSTANTIATE(ImageMessage)
VPSLAM_INSTANTIATE(FrameFeatures)
VPSLAM_INSTANTIATE(LineSet)
VPSLAM_INSTANTIATE(LinesRequest)
VPSLAM_INSTANTIATE(FramePose)
VPSLAM_INSTANTIATE(Truth)
VPSLAM_INSTANTIATE(KeyframeProposal)
VPSLAM_INSTANTIATE(MapDelta)
VPSLAM_INSTANTIATE(MapRequest)
VPSLAM_INSTANTIATE(Ack)
VPSLAM_INSTANTIATE(Command)
VPSLAM_INSTANTIATE(RunDescription)
VPSLAM_INSTANTIATE(ProcessStatus)
VPSLAM_INSTANTIATE(Preview)
#undef VPSLAM_INSTANTIATE

}  // namespace vpslam
