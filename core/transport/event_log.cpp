#include "core/transport/event_log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <lcm/eventlog.h>

namespace vpslam {
namespace {

constexpr std::array<uint8_t, 4> kSyncWord = {0xED, 0xA1, 0xDA, 0x01};

/// Sync word, number of the event, time, lengths of channel and data; big-endian.
constexpr int64_t kHeaderBytes = 4 + 8 + 8 + 4 + 4;
constexpr int64_t kMaxChannelBytes = 999;   ///< as LCM's reader has it
constexpr int64_t kMaxDataBytes = 1 << 30;  ///< far more than a message has

constexpr std::uintmax_t kSpaceLeftBytes = 32'000'000;
constexpr int64_t kCheckSpaceEveryBytes = 1'000'000;

/// Whether the lengths in the header of an event, where all of it is there, are those of one: for
/// files that do not begin with it.
bool LooksLikeAnEvent(std::span<const uint8_t> bytes) {
  if (std::ssize(bytes) < kHeaderBytes) return false;
  const auto length = [&](size_t at) {
    return static_cast<int64_t>(bytes[at]) << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 |
           bytes[at + 3];
  };
  return length(20) >= 1 && length(20) <= kMaxChannelBytes && length(24) <= kMaxDataBytes;
}

struct Destroy {
  void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
};
using Handle = std::unique_ptr<lcm_eventlog_t, Destroy>;

}  // namespace

class EventLogWriter::Impl {
 public:
  explicit Impl(const std::string& path) : path_(path) {
    log_.reset(lcm_eventlog_create(path.c_str(), "w"));
    if (!log_) Fail();
  }

  void Write(int64_t stamp_us, const std::string& channel, std::span<const uint8_t> bytes) {
    lcm_eventlog_event_t event{};
    event.timestamp = stamp_us;
    event.channellen = static_cast<int32_t>(channel.size());
    event.datalen = static_cast<int32_t>(bytes.size());
    // LCM only reads them.
    event.channel = const_cast<char*>(channel.c_str());
    event.data = const_cast<uint8_t*>(bytes.data());
    LeaveSpace(static_cast<int64_t>(channel.size() + bytes.size()));
    if (lcm_eventlog_write_event(log_.get(), &event) != 0) Fail();
  }

  void Flush() {
    if (std::fflush(log_->f) != 0 || std::ferror(log_->f)) Fail();
  }

 private:
  /// Whatever else the run leaves behind has to find room, too.
  void LeaveSpace(int64_t bytes) {
    unchecked_bytes_ -= bytes;
    if (unchecked_bytes_ > 0) return;
    unchecked_bytes_ = kCheckSpaceEveryBytes;
    std::error_code error;
    const auto space = std::filesystem::space(path_, error);
    if (error || space.available >= kSpaceLeftBytes) return;
    errno = ENOSPC;
    Fail();
  }

  [[noreturn]] void Fail() const {
    throw std::runtime_error(path_ + ": cannot be written (" + std::strerror(errno) +
                             "); free space, or name another folder with --out");
  }

  const std::string path_;
  Handle log_;
  int64_t unchecked_bytes_ = 0;
};

EventLogWriter::EventLogWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
EventLogWriter::~EventLogWriter() = default;
void EventLogWriter::Write(int64_t stamp_us, const std::string& channel,
                           std::span<const uint8_t> bytes) {
  impl_->Write(stamp_us, channel, bytes);
}
void EventLogWriter::Flush() { impl_->Flush(); }

class EventLogReader::Impl {
 public:
  explicit Impl(const std::string& path) : path_(path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
      throw std::runtime_error(path + ": no such file; `vpslam run --record features` or `all` " +
                               "leaves a log.lcm");
    }
    file_.open(path, std::ios::binary);
    if (!file_) throw std::runtime_error(path + ": cannot be read (" + std::strerror(errno) + ")");
    if (!IsEventLog(path)) {
      throw std::runtime_error(path + ": is no log of LCM messages; name the log.lcm of a run");
    }
    size_ = static_cast<int64_t>(std::filesystem::file_size(path, error));
  }

  std::optional<LogEvent> Next() {
    while (next_ < size_) {
      const std::optional<EventHeader> header = HeaderAt(next_);
      std::optional<LogEvent> event;
      // Before the look at what follows, so that the file is read from front to back.
      if (header && header->end <= size_) event = Read(*header);
      const int64_t within = header ? BeginWithin(*header) : -1;
      if (event && within < 0) {
        position_ = next_;
        next_ = header->end;
        return event;
      }
      const int64_t found = within >= 0 ? within : FindEvent(next_ + 1, size_);
      cut_off_ =
          found == size_ && (size_ - next_ < kHeaderBytes || (header && header->end > size_));
      damaged_bytes_ += found - next_;
      ++damaged_places_;
      next_ = found;
    }
    return std::nullopt;
  }

  LogEvent ReadAt(int64_t position) {
    const auto header = HeaderAt(position);
    if (!header || header->end > size_) {
      throw std::runtime_error(path_ + ": has changed while it was read; read it again");
    }
    return Read(*header);
  }

  int64_t position() const { return position_; }
  int64_t damaged_bytes() const { return damaged_bytes_; }
  int64_t damaged_places() const { return damaged_places_; }
  bool cut_off() const { return cut_off_; }

 private:
  struct EventHeader {
    int64_t stamp_us = 0;
    int64_t begin = 0, channel = 0, data = 0, end = 0;  // positions in the file
  };

  /// False at the end of the file.
  bool ReadBytes(int64_t at, int64_t n, uint8_t* bytes) {
    if (at + n > size_) return false;
    file_.clear();
    if (file_.tellg() != at) file_.seekg(at);
    return static_cast<bool>(file_.read(reinterpret_cast<char*>(bytes), n));
  }

  static int64_t BigEndian(const uint8_t* bytes, int n) {
    uint64_t value = 0;
    for (int i = 0; i < n; ++i) value = value << 8 | bytes[i];
    return static_cast<int64_t>(value);
  }

  /// nullopt where no event can begin.
  std::optional<EventHeader> HeaderAt(int64_t at) {
    if (newest_ && newest_->begin == at) return newest_;
    std::array<uint8_t, kHeaderBytes> bytes{};
    if (!ReadBytes(at, kHeaderBytes, bytes.data())) return std::nullopt;
    if (!std::equal(kSyncWord.begin(), kSyncWord.end(), bytes.begin())) return std::nullopt;
    const int64_t channel_bytes = BigEndian(&bytes[20], 4), data_bytes = BigEndian(&bytes[24], 4);
    if (channel_bytes < 1 || channel_bytes > kMaxChannelBytes || data_bytes > kMaxDataBytes) {
      return std::nullopt;
    }
    EventHeader header;
    header.stamp_us = BigEndian(&bytes[12], 8);
    header.begin = at;
    header.channel = at + kHeaderBytes;
    header.data = header.channel + channel_bytes;
    header.end = header.data + data_bytes;
    newest_ = header;
    return header;
  }

  /// True if behind the event another one begins, or the file ends.
  bool IsFollowed(const EventHeader& header) {
    if (header.end >= size_) return header.end == size_;
    return HeaderAt(header.end).has_value();
  }

  /// Where an event begins within this one, which then was cut off; negative if none does, and this
  /// one is whole. Bytes of a message may happen to look like an event, but hardly like one that
  /// another one follows, and there too.
  int64_t BeginWithin(const EventHeader& header) {
    if (IsFollowed(header)) return -1;
    const int64_t end = std::min(header.end, size_);
    const int64_t found = FindEvent(header.begin + 1, end);
    if (found < end) return found;
    return header.end > size_ ? end : -1;
  }

  /// The first position from `at` on where an event begins; `end` if there is none before it.
  int64_t FindEvent(int64_t at, int64_t end) {
    constexpr int64_t kBlock = 1 << 20;
    std::vector<uint8_t> block;
    while (at < end) {
      const int64_t n = std::min(kBlock, size_ - at);
      block.resize(static_cast<size_t>(n));
      if (n < kHeaderBytes || !ReadBytes(at, n, block.data())) return end;
      for (auto found = block.begin();;) {
        found = std::search(found, block.end(), kSyncWord.begin(), kSyncWord.end());
        const int64_t position = at + (found - block.begin());
        if (found == block.end() || position >= end) break;
        const auto header = HeaderAt(position);
        if (header && (IsFollowed(*header) || header->end > size_)) return position;
        ++found;
      }
      at += n - static_cast<int64_t>(kSyncWord.size()) + 1;
      if (n < kBlock) break;
    }
    return end;
  }

  LogEvent Read(const EventHeader& header) {
    LogEvent event;
    event.stamp_us = header.stamp_us;
    event.channel.resize(static_cast<size_t>(header.data - header.channel));
    event.bytes.resize(static_cast<size_t>(header.end - header.data));
    ReadBytes(header.channel, header.data - header.channel,
              reinterpret_cast<uint8_t*>(event.channel.data()));
    ReadBytes(header.data, header.end - header.data, event.bytes.data());
    return event;
  }

  const std::string path_;
  std::ifstream file_;
  std::optional<EventHeader> newest_;  // that was read
  int64_t size_ = 0;
  int64_t next_ = 0;      // where the next event is looked for
  int64_t position_ = 0;  // of the event that was read last
  int64_t damaged_bytes_ = 0, damaged_places_ = 0;
  bool cut_off_ = false;
};

EventLogReader::EventLogReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
EventLogReader::~EventLogReader() = default;
std::optional<LogEvent> EventLogReader::Next() { return impl_->Next(); }
int64_t EventLogReader::position() const { return impl_->position(); }
LogEvent EventLogReader::ReadAt(int64_t position) { return impl_->ReadAt(position); }
int64_t EventLogReader::damaged_bytes() const { return impl_->damaged_bytes(); }
int64_t EventLogReader::damaged_places() const { return impl_->damaged_places(); }
bool EventLogReader::cut_off() const { return impl_->cut_off(); }

bool IsEventLog(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  std::vector<uint8_t> begin(1 << 16);
  file.read(reinterpret_cast<char*>(begin.data()), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<size_t>(file.gcount()));
  const auto found = std::search(begin.begin(), begin.end(), kSyncWord.begin(), kSyncWord.end());
  return found != begin.end() && (found == begin.begin() || LooksLikeAnEvent({found, begin.end()}));
}

}  // namespace vpslam
