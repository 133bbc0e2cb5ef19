// The sending end of a reliable stream: every required consumer gets every message, in order.
//
// Each message is kept until all required consumers have acknowledged it, and sent again
// (go-back-N, 50 to 500 ms) while one of them has not received it. At most `window` messages are
// unacknowledged at a time; Send blocks then, or gives up the oldest of them (drop_oldest).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/transport/bus.h"
#include "core/transport/clock.h"
#include "core/transport/codec.h"

namespace vpslam {

struct StreamWriterOptions {
  int window = 4;
  /// A full window never blocks: its oldest message is kept no more, and a reader that has not
  /// received it goes on with the one after it.
  bool drop_oldest = false;
  std::chrono::milliseconds first_resend{50};
  std::chrono::milliseconds max_resend{500};  ///< the interval doubles up to this
  /// A consumer that was sent something and says nothing for so long is dead. Its receive thread
  /// answers by itself, however busy its worker is.
  std::chrono::milliseconds peer_timeout{30000};
  int64_t session = 0;  ///< 0: that of the bus

  std::optional<std::string> Validate() const;
};

/// A process that has to answer does not; what() is one line for people.
class PeerGoneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What does not depend on the type of the message. All members may be called from any thread.
class StreamWriterCore {
 public:
  /// Makes the datagram of the message with this header.
  using Encoder = std::function<std::vector<uint8_t>(const Header&)>;

  StreamWriterCore(Bus& bus, std::string channel, std::vector<std::string> consumers,
                   const StreamWriterOptions& options);
  ~StreamWriterCore();

  bool WaitForRoom();
  bool HasRoom() const;
  bool Send(const Encoder& encoder, bool last);
  bool WaitAllAcked(std::chrono::milliseconds timeout);
  int64_t next_seq() const;
  int64_t acked() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

template <class T>
class StreamWriter {
 public:
  /// Without consumers nothing is waited for and the stream is best effort.
  StreamWriter(Bus& bus, std::string channel, std::vector<std::string> consumers,
               const StreamWriterOptions& options = {})
      : core_(bus, std::move(channel), std::move(consumers), options) {}

  /// Blocks while the window is full, unless it drops. False when the bus was interrupted; throws
  /// PeerGoneError, or std::invalid_argument if the value may not be sent.
  bool Send(const T& value) {
    return core_.Send([&value](const Header& header) { return Encode(header, value); }, false);
  }
  /// Blocks until Send would not; same result.
  bool WaitForRoom() { return core_.WaitForRoom(); }
  /// Whether Send would go through at once. Throws PeerGoneError.
  bool HasRoom() const { return core_.HasRoom(); }
  /// Sends the end-of-stream marker; nothing may follow.
  bool SendEnd() {
    return core_.Send([](const Header& header) { return Encode(header, T{}); }, true);
  }
  /// True when all consumers have acknowledged everything; false after `timeout` or an interrupt;
  /// throws PeerGoneError.
  bool WaitAllAcked(std::chrono::milliseconds timeout) { return core_.WaitAllAcked(timeout); }

  int64_t next_seq() const { return core_.next_seq(); }  ///< that the next Send will use
  /// All messages up to this one were acknowledged by all; -1 for none.
  int64_t acked() const { return core_.acked(); }

 private:
  StreamWriterCore core_;
};

}  // namespace vpslam
