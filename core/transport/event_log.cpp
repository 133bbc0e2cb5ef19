#include "core/transport/event_log.h"

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

constexpr std::uintmax_t kSpaceLeftBytes = 32'000'000;
constexpr int64_t kCheckSpaceEveryBytes = 1'000'000;

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
  explicit Impl(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
      throw std::runtime_error(path + ": no such file; `vpslam run --record features` or `all` " +
                               "leaves a log.lcm");
    }
    if (std::ifstream file(path, std::ios::binary); !file) {
      throw std::runtime_error(path + ": cannot be read (" + std::strerror(errno) + ")");
    }
    if (!IsEventLog(path)) {
      throw std::runtime_error(path + ": is no log of LCM messages; name the log.lcm of a run");
    }
    log_.reset(lcm_eventlog_create(path.c_str(), "r"));
    if (!log_) throw std::runtime_error(path + ": cannot be read (" + std::strerror(errno) + ")");
    size_bytes_ = static_cast<int64_t>(std::filesystem::file_size(path, error));
  }

  std::optional<LogEvent> Next() {
    lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log_.get());
    if (!event) {
      damaged_bytes_ = size_bytes_ - position_;
      return std::nullopt;
    }
    const auto* data = static_cast<const uint8_t*>(event->data);
    LogEvent result{event->timestamp,
                    std::string(event->channel, static_cast<std::size_t>(event->channellen)),
                    {data, data + event->datalen}};
    lcm_eventlog_free_event(event);
    position_ = static_cast<int64_t>(ftello(log_->f));
    return result;
  }

  int64_t damaged_bytes() const { return damaged_bytes_; }

 private:
  Handle log_;
  int64_t size_bytes_ = 0;
  int64_t position_ = 0;  // behind the last whole event
  int64_t damaged_bytes_ = 0;
};

EventLogReader::EventLogReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
EventLogReader::~EventLogReader() = default;
std::optional<LogEvent> EventLogReader::Next() { return impl_->Next(); }
int64_t EventLogReader::damaged_bytes() const { return impl_->damaged_bytes(); }

bool IsEventLog(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  std::array<uint8_t, 4> begin{};
  return file.read(reinterpret_cast<char*>(begin.data()), begin.size()) && begin == kSyncWord;
}

}  // namespace vpslam
