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

/// Leaves out what is damaged and goes on behind it: foreign bytes, and events that were cut off
/// before others were appended. Code of its own, since LCM 1.3.1 ends at the first of these.
class EventLogReader {
 public:
  /// Throws std::runtime_error with one line if there is no such log.
  explicit EventLogReader(const std::string& path);
  ~EventLogReader();
  EventLogReader(const EventLogReader&) = delete;
  EventLogReader& operator=(const EventLogReader&) = delete;

  /// The next whole event; nullopt at the end, also where the last event is cut off (its writer was
  /// killed).
  std::optional<LogEvent> Next();

  /// Of the event that Next() gave; ReadAt takes it.
  int64_t position() const;
  /// The event at a position() of this log, whatever Next() comes to.
  LogEvent ReadAt(int64_t position);

  /// Bytes so far that belong to no whole event, and in how many places they are.
  int64_t damaged_bytes() const;
  int64_t damaged_places() const;
  /// Whether the file ends within an event; known when Next() came to the end.
  bool cut_off() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// True if the file begins as such a log does, also behind some damage.
bool IsEventLog(const std::string& path);

}  // namespace vpslam
