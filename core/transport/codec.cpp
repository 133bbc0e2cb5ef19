#include "core/transport/codec.h"

#include <algorithm>
#include <stdexcept>

#include "core/geometry/camera.h"
#include "core/messages/command.h"
#include "core/messages/frame_features.h"
#include "core/messages/frame_pose.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/lines_request.h"
#include "core/messages/map_delta.h"
#include "core/messages/map_request.h"
#include "core/messages/outcome.h"
#include "core/messages/preview.h"
#include "core/messages/process_status.h"
#include "core/messages/run_description.h"
#include "core/messages/truth.h"
#include "core/messages/validate.h"
#include "core/transport/ack.h"
#include "core/transport/fingerprint.h"
#include "core/transport/image_message.h"
#include "core/transport/wire_reader.h"
#include "core/transport/wire_writer.h"

namespace vpslam {
namespace {

// Every message begins with its fingerprint and header_t, of which session and seq come first.
constexpr std::size_t kOldestSeqOffset = 3 * sizeof(int64_t);

template <class T>
int64_t Fingerprint() {
  static const int64_t fingerprint = FingerprintHash::Of<Header, T>();
  return fingerprint;
}

}  // namespace

template <class T>
std::vector<uint8_t> Encode(const Header& header, const T& value) {
  if (const Fault fault = Validate(header)) throw std::invalid_argument("header." + *fault);
  if (!header.last) {
    if (const Fault fault = Validate(value)) {
      throw std::invalid_argument(std::string(Description<T>::kWireName) +
                                  " cannot be sent: " + *fault);
    }
  }
  const T nothing{};
  const T& payload = header.last ? nothing : value;
  WireWriter writer;
  writer.Put(Fingerprint<T>());
  Description<Header>::Visit(writer, header);
  const ArrayLengths arrays = CollectArrayLengths(payload);
  for (const ArrayLength& length : arrays.lengths()) writer.Put(static_cast<int32_t>(length.size));
  Description<T>::Visit(writer, payload);
  return writer.Take();
}

template <class T>
std::optional<Decoded<T>> Decode(std::span<const uint8_t> bytes, std::string* why) {
  WireReader reader(bytes);
  const auto fingerprint = reader.Get<int64_t>();
  if (!reader.fault() && fingerprint != Fingerprint<T>()) {
    *why = "another type of message, or another version of it";
    return std::nullopt;
  }
  Decoded<T> decoded;
  Description<Header>::Visit(reader, decoded.header);
  reader.ReadLengths<T>();
  if (!reader.fault()) Description<T>::Visit(reader, decoded.value);
  if (reader.fault() || !reader.AtEnd()) {
    *why = reader.fault() ? reader.fault() : "length does not fit the content";
    return std::nullopt;
  }
  Fault fault = Validate(decoded.header);
  if (!fault && !decoded.header.last) fault = Validate(decoded.value);
  if (fault) {
    *why = *std::move(fault);
    return std::nullopt;
  }
  if (decoded.header.last) decoded.value = T();
  return decoded;
}

std::optional<Header> PeekHeader(std::span<const uint8_t> bytes) {
  WireReader reader(bytes);
  reader.Get<int64_t>();  // fingerprint
  Header header;
  Description<Header>::Visit(reader, header);
  if (reader.fault()) return std::nullopt;
  return header;
}

void SetOldestSeq(std::vector<uint8_t>* bytes, int64_t oldest_seq) {
  WireWriter writer;
  writer.Put(oldest_seq);
  const std::vector<uint8_t> value = writer.Take();
  std::copy(value.begin(), value.end(), bytes->begin() + kOldestSeqOffset);
}

#define VPSLAM_INSTANTIATE(T, type)                              \
  template std::vector<uint8_t> Encode(const Header&, const T&); \
  template std::optional<Decoded<T>> Decode<T>(std::span<const uint8_t>, std::string*);
VPSLAM_MESSAGES(VPSLAM_INSTANTIATE)
#undef VPSLAM_INSTANTIATE

}  // namespace vpslam
