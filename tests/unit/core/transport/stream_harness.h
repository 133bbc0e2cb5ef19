// One stream and its consumers, in threads, and what they got.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/messages/preview.h"
#include "core/transport/bus.h"
#include "core/transport/stream_reader.h"
#include "core/transport/stream_writer.h"

namespace vpslam::test {

using namespace std::chrono_literals;

inline constexpr const char* kTestStream = "TEST";

/// A message of `size` bytes that can be recognised.
inline Preview Numbered(int64_t number, std::size_t size = 16) {
  Preview p;
  p.frame_seq = number;
  p.jpeg.assign(size, static_cast<uint8_t>(number));
  return p;
}

inline StreamWriterOptions QuickResend(int window) {
  StreamWriterOptions options;
  options.window = window;
  options.first_resend = 30ms;
  options.max_resend = 120ms;
  options.peer_timeout = 20s;
  return options;
}

/// Reads until the end of the stream, in a thread of its own.
class Consumer {
 public:
  Consumer(Bus& bus, const std::string& name, AckPolicy policy,
           std::chrono::milliseconds work = 0ms)
      : bus_(bus),
        policy_(policy),
        work_(work),
        reader_(std::make_unique<StreamReader<Preview>>(bus, kTestStream, name, policy)),
        thread_([this] { Run(); }) {}
  ~Consumer() { Join(); }
  void Join() {
    if (thread_.joinable()) thread_.join();
  }
  const std::vector<int64_t>& numbers() const { return numbers_; }  ///< after Join
  bool ended() const { return ended_; }
  bool contents_right() const { return contents_right_; }

 private:
  void Run() {
    while (bus_.WaitFor([this] { return reader_->HasNews(); }, 20s)) {
      if (reader_->Ended()) {
        ended_ = true;
        break;
      }
      const auto item = reader_->TryTake();
      if (!item) continue;
      if (work_ > 0ms) std::this_thread::sleep_for(work_);
      numbers_.push_back(item->value.frame_seq);
      for (const uint8_t b : item->value.jpeg) {
        contents_right_ &= b == static_cast<uint8_t>(item->value.frame_seq);
      }
      if (policy_ == AckPolicy::kWhenDone) reader_->Done(item->header);
    }
    reader_.reset();
  }

  Bus& bus_;
  const AckPolicy policy_;
  const std::chrono::milliseconds work_;
  std::unique_ptr<StreamReader<Preview>> reader_;
  std::vector<int64_t> numbers_;
  bool ended_ = false;
  bool contents_right_ = true;
  std::thread thread_;
};

inline std::vector<int64_t> Count(int64_t from, int64_t to) {
  std::vector<int64_t> numbers;
  for (int64_t i = from; i < to; ++i) numbers.push_back(i);
  return numbers;
}

}  // namespace vpslam::test
