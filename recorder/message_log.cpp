#include "recorder/message_log.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "core/messages/command.h"
#include "core/messages/frame_features.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/truth.h"
#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "core/transport/codec.h"
#include "core/transport/event_log.h"
#include "core/transport/image_message.h"
#include "core/transport/image_pool.h"
#include "core/transport/publisher.h"
#include "core/transport/sequence_watch.h"

namespace vpslam {
namespace {

constexpr const char* kName = "recorder";
constexpr std::chrono::seconds kAskForCameraEvery{1};
/// What nobody waits for is written together: each awakening costs more than what it writes.
constexpr std::chrono::milliseconds kWriteEvery{20};

using Bytes = std::vector<uint8_t>;

}  // namespace

class MessageLog::Impl {
 public:
  Impl(Bus& bus, const MessageLogOptions& options)
      : bus_(bus), options_(options), file_(options.path), camera_requests_(bus, kCommandChannel) {
    for (const char* channel :
         {kCameraChannel, kLinesChannel, kLinesRequestChannel, kMapRequestChannel, kAckChannel,
          kCommandChannel, kStatusChannel, kPreviewChannel, kOutcomeChannel}) {
      registrations_.push_back(
          bus.Subscribe(channel, [this, channel](std::span<const uint8_t> bytes) {
            Add({RealtimeMicroseconds(), channel, Bytes(bytes.begin(), bytes.end()), {}});
          }));
    }
    truths_ = std::make_unique<StreamReader<Truth>>(
        bus, kTruthChannel, kName, AckPolicy::kOnReceipt, Tap<Truth>(kTruthChannel));
    keyframes_ = std::make_unique<StreamReader<KeyframeProposal>>(
        bus, kKeyframeChannel, kName, AckPolicy::kOnReceipt,
        Tap<KeyframeProposal>(kKeyframeChannel));
    features_ = std::make_unique<StreamReader<FrameFeatures>>(
        bus, kFeaturesChannel, kName, AckPolicy::kWhenDone,
        [this](const Decoded<FrameFeatures>& message, std::span<const uint8_t> bytes) {
          Add({RealtimeMicroseconds(), kFeaturesChannel, Bytes(bytes.begin(), bytes.end()),
               [this, header = message.header] { features_->Done(header); }});
          return false;
        });
    if (options.pixels) SubscribeToImages();
    timer_ = bus.OnTick([this] { Tick(); });
    thread_ = std::thread([this] { RunWriter(); });  // when all that it uses is there
  }

  ~Impl() { Close(); }

  template <class T>
  typename StreamReader<T>::Tap Tap(const char* channel, bool wanted = false) {
    return [this, channel, wanted](const Decoded<T>&, std::span<const uint8_t> bytes) {
      Add({RealtimeMicroseconds(), channel, Bytes(bytes.begin(), bytes.end()), {}});
      return wanted;
    };
  }

  bool StreamsEnded() const {
    return truths_->Ended() && keyframes_->Ended() && features_->Ended() &&
           (!images_ || images_->Ended());
  }

  void Close() {
    timer_.Cancel();
    registrations_.clear();
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  std::optional<std::string> error() const {
    const std::lock_guard lock(mutex_);
    return error_;
  }
  int64_t left_out() const {
    const std::lock_guard lock(mutex_);
    return left_out_;
  }
  std::map<std::string, Count> counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }
  const std::string& path() const { return options_.path; }

 private:
  struct Entry {
    int64_t stamp_us = 0;
    std::string channel;
    Bytes bytes;
    std::function<void()> done = {};  ///< to be called when it is in the file; may be empty
    std::optional<Decoded<ImageMessage>> image = {};  ///< whose pixels still lie in shared memory
  };

  void SubscribeToImages() {
    images_ = std::make_unique<StreamReader<ImageMessage>>(
        bus_, kImageChannel, kName, AckPolicy::kWhenDone,
        [this](const Decoded<ImageMessage>& image, std::span<const uint8_t> bytes) {
          Entry entry{RealtimeMicroseconds(), kImageChannel, {}, {}, {}};
          entry.done = [this, header = image.header] { images_->Done(header); };
          if (!image.header.last && !image.value.segment.empty()) {
            entry.image = image;
          } else {
            entry.bytes.assign(bytes.begin(), bytes.end());
          }
          Add(std::move(entry));
          return false;
        });
  }

  void Add(Entry entry) {
    const bool is_awaited = static_cast<bool>(entry.done);
    {
      const std::lock_guard lock(mutex_);
      if (closing_) return;
      waiting_bytes_ += entry.bytes.size();
      is_awaited_ |= is_awaited;
      // In real time nobody waits for a disk that is too slow. Without its content a message is
      // left out, but still said to be done with.
      if (waiting_bytes_ > options_.max_waiting_bytes) {
        waiting_bytes_ -= entry.bytes.size();
        entry.bytes = {};
        entry.image.reset();
        ++left_out_;
      }
      queue_.push_back(std::move(entry));
    }
    if (is_awaited) changed_.notify_all();
  }

  void Tick() {
    const auto now = std::chrono::steady_clock::now();
    if (begun_ || now < asked_ + kAskForCameraEvery) return;
    asked_ = now;
    camera_requests_.Publish({"player", CommandAction::kSendCamera});
  }

  // ---- The writer's thread ----

  void RunWriter() {
    std::deque<Entry> before_camera, taken;
    std::unique_lock lock(mutex_);
    while (!closing_ || !queue_.empty()) {
      changed_.wait_for(lock, kWriteEvery, [this] { return closing_ || is_awaited_; });
      taken.swap(queue_);
      is_awaited_ = false;
      waiting_bytes_ = 0;
      lock.unlock();
      for (Entry& entry : taken) {
        if (begun_) {
          Write(std::move(entry));
        } else if (entry.channel != kCameraChannel) {
          before_camera.push_back(std::move(entry));
        } else {
          begun_ = true;
          Write(std::move(entry));
          WriteRun();
          WriteAll(&before_camera);
        }
      }
      taken.clear();
      lock.lock();
    }
    lock.unlock();
    if (!before_camera.empty()) WriteRun();
    WriteAll(&before_camera);
    Guard([this] { file_.Flush(); });
  }

  void WriteAll(std::deque<Entry>* entries) {
    for (Entry& entry : *entries) Write(std::move(entry));
    entries->clear();
  }

  void WriteRun() {
    Header header;
    header.session = bus_.session();
    header.stamp_us = RealtimeMicroseconds();
    Guard([&] { Write({header.stamp_us, kRunChannel, Encode(header, options_.run), {}, {}}); });
  }

  void Write(Entry entry) {
    if (entry.image && !Inline(&entry)) return;
    if (entry.bytes.empty()) {  // left out
      if (entry.done) entry.done();
      return;
    }
    Guard([&] { file_.Write(entry.stamp_us, entry.channel, entry.bytes); });
    if (entry.done) entry.done();
    const auto header = PeekHeader(entry.bytes);
    const int64_t missed =
        header && HasSequence(entry.channel) ? watches_[entry.channel].See(*header).missed : 0;
    const std::lock_guard lock(mutex_);
    if (error_) return;
    Count& count = counts_[entry.channel];
    ++count.messages;
    count.bytes += static_cast<int64_t>(entry.bytes.size());
    count.gaps += missed;
  }

  /// Puts the pixels into the message; false if they are gone, and with them the image.
  bool Inline(Entry* entry) {
    std::string why;
    const auto frame = fetcher_.Fetch(entry->image->value, &why);
    if (frame) {
      entry->bytes = Encode(entry->image->header, InlineImage(*frame));
      return true;
    }
    spdlog::warn("frame {} is missing in the log: {}", entry->image->value.frame_seq, why);
    {
      const std::lock_guard lock(mutex_);
      ++left_out_;
    }
    if (entry->done) entry->done();
    return false;
  }

  /// A log that cannot be written is given up, once; the run is worth more.
  void Guard(const std::function<void()>& write) {
    {
      const std::lock_guard lock(mutex_);
      if (error_) return;
    }
    try {
      write();
    } catch (const std::exception& e) {
      spdlog::error("{}; the log ends here", e.what());
      const std::lock_guard lock(mutex_);
      error_ = e.what();
    }
  }

  Bus& bus_;
  const MessageLogOptions options_;
  EventLogWriter file_;                           // of the writer's thread, as
  ImageFetcher fetcher_;                          // this
  std::map<std::string, SequenceWatch> watches_;  // and this
  Publisher<Command> camera_requests_;            // of the timer's thread, as
  std::chrono::steady_clock::time_point asked_ = std::chrono::steady_clock::now();  // this
  std::atomic<bool> begun_ = false;  // the camera has come

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  bool is_awaited_ = false;  // something in the queue is
  std::size_t waiting_bytes_ = 0;
  int64_t left_out_ = 0;
  bool closing_ = false;
  std::optional<std::string> error_;
  std::map<std::string, Count> counts_;

  std::thread thread_;
  std::unique_ptr<StreamReader<Truth>> truths_;
  std::unique_ptr<StreamReader<KeyframeProposal>> keyframes_;
  std::unique_ptr<StreamReader<FrameFeatures>> features_;
  std::unique_ptr<StreamReader<ImageMessage>> images_;
  std::vector<Bus::Registration> registrations_;
  Bus::Registration timer_;
};

MessageLog::MessageLog(Bus& bus, const MessageLogOptions& options)
    : impl_(std::make_unique<Impl>(bus, options)) {}
MessageLog::~MessageLog() = default;
StreamReader<FramePose>::Tap MessageLog::PoseTap() {
  return impl_->Tap<FramePose>(kPoseChannel, true);
}
StreamReader<MapDelta>::Tap MessageLog::MapTap() { return impl_->Tap<MapDelta>(kMapChannel, true); }
bool MessageLog::StreamsEnded() const { return impl_->StreamsEnded(); }
void MessageLog::Close() { impl_->Close(); }
std::optional<std::string> MessageLog::error() const { return impl_->error(); }
int64_t MessageLog::left_out() const { return impl_->left_out(); }
std::map<std::string, MessageLog::Count> MessageLog::counts() const { return impl_->counts(); }
const std::string& MessageLog::path() const { return impl_->path(); }

}  // namespace vpslam
