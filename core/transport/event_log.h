// Logs of messages as files, in the format of lcm-logger and lcm-logplayer.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpslam {

struct LogEvent {
  int64_t stamp_us = 0;  ///< CLOCK_REALTIME when the message was received
  std::string channel;
  std::vector<uint8_t> bytes;  ///< the message as it travels
};

/// One thread at a time.
class EventLogWriter {
 public:
  /// Replaces a file of that name. Throws std::runtime_error with one line that names the remedy.
  explicit EventLogWriter(const std::string& path);
  ~EventLogWriter();
  EventLogWriter(const EventLogWriter&) = delete;
  EventLogWriter& operator=(const EventLogWriter&) = delete;

  /// Throws std::runtime_error if the event cannot be written as a whole, and while the disk is so
  /// full (32 MB free) that a run's results would find no room.
  void Write(int64_t stamp_us, const std::string& channel, std::span<const uint8_t> bytes);
  /// Hands everything to the operating system; throws as Write does.
  void Flush();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

class EventLogReader {
 public:
  /// Throws std::runtime_error with one line if there is no such log.
  explicit EventLogReader(const std::string& path);
  ~EventLogReader();
  EventLogReader(const EventLogReader&) = delete;
  EventLogReader& operator=(const EventLogReader&) = delete;

  /// nullopt at the end, also where the last event is cut off (its writer was killed), and where
  /// the file is damaged: LCM reads no further.
  std::optional<LogEvent> Next();
  /// Bytes at the end that belong to no whole event; 0 before Next() came to the end.
  int64_t damaged_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// True if the file begins as such a log does.
bool IsEventLog(const std::string& path);

}  // namespace vpslam
