#include "player/play.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "core/messages/command.h"
#include "core/messages/truth.h"
#include "core/transport/camera_link.h"
#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "core/transport/image_message.h"
#include "core/transport/image_pool.h"
#include "core/transport/inbox.h"
#include "core/transport/publisher.h"
#include "core/transport/receive_buffer.h"
#include "core/transport/stream_writer.h"
#include "player/tempo.h"

namespace vpslam {
namespace {

constexpr std::chrono::seconds kTellWaitingAfter{5};
/// Stopped before all were there: those that are hear of the end, but nobody is waited for.
constexpr std::chrono::seconds kPatienceWithTheUnready{1};
/// How often a wait looks at whether it still makes sense.
constexpr std::chrono::milliseconds kLookAround{200};

class Player {
 public:
  Player(Bus& bus, Peers& peers, StatusReporter& status, ImageSource& source,
         const PlayOptions& options, const std::atomic<bool>& stop)
      : bus_(bus),
        peers_(peers),
        status_(status),
        source_(source),
        options_(options),
        stop_(stop),
        consumers_(RequiredConsumers(kImageConsumers, options.required)),
        commands_(bus, kCommandChannel, Inbox<Command>::kUnbounded),
        camera_(bus, source.camera()),
        truth_(bus, kTruthChannel),
        images_(bus, kImageChannel, consumers_, WriterOptions(options.pace)),
        tempo_(source.IsLive()) {
    if (!options.inline_pixels) {
      const Camera& c = source.camera();
      pool_ = std::make_unique<ImagePool>(ImageSegmentName(bus.session()), Slots(options.pace),
                                          static_cast<size_t>(c.width) * c.height);
    }
  }

  int64_t Run() {
    status_.SetState(ProcessState::kReady);
    if (!WaitForConsumers()) {
      images_.SendEnd();
      images_.WaitAllAcked(kPatienceWithTheUnready);
      return 0;
    }
    status_.SetState(ProcessState::kRunning, Warning());
    const std::exception_ptr broken = SendImages();
    if (tempo_.restarts() > 0) {
      spdlog::warn("late by more than {} s {} times, and went on from there",
                   std::chrono::duration<double>(Tempo::kMaxDebt).count(), tempo_.restarts());
    }
    End();
    if (broken) std::rethrow_exception(broken);
    return sent_;
  }

 private:
  static constexpr int kLosslessWindow = 4;
  /// In realtime a slot is used again after so many images, whether or not they were looked at.
  /// Readers copy an image when they take it up, and drop what waits longer than this.
  static constexpr int kRealtimeSlots = 12;

  static StreamWriterOptions WriterOptions(Pace pace) {
    StreamWriterOptions options;
    options.window = pace == Pace::kLossless ? kLosslessWindow : 1;
    options.drop_oldest = pace == Pace::kRealtime;
    return options;
  }
  static int Slots(Pace pace) {
    return pace == Pace::kRealtime ? kRealtimeSlots : WriterOptions(pace).window + 1;
  }

  /// What a person had better know from the start; empty if there is nothing.
  std::string Warning() const {
    const std::optional<int> asked = AskedReceiveBuffer(bus_.url());
    if (pool_ || !asked) return {};
    const Camera& c = source_.camera();
    const auto why = WhyInlineImagesGetLost(*asked, GrantedReceiveBuffer(*asked),
                                            static_cast<size_t>(c.width) * c.height,
                                            WriterOptions(options_.pace).window);
    if (why) spdlog::warn("{}", *why);
    return why.value_or("");
  }

  bool Stopping() {
    while (const auto command = commands_.TryTake()) {
      const Command& c = command->value;
      stopped_ |= c.action == CommandAction::kStop && (c.target.empty() || c.target == "player");
    }
    stopped_ |= stop_ || bus_.interrupted();
    return stopped_;
  }

  void ThrowIfAnyoneIsGone() const {
    for (const std::string& process : options_.required) {
      if (const auto why = peers_.WhyGone(process)) throw PeerGoneError(*why);
    }
  }

  /// False if the run was stopped before all were ready.
  bool WaitForConsumers() {
    const auto ready = [this] { return Stopping() || peers_.NotReady(options_.required).empty(); };
    while (!bus_.WaitFor(ready, kTellWaitingAfter) && !Stopping()) {
      ThrowIfAnyoneIsGone();
      spdlog::info("waiting for {} to be ready",
                   fmt::join(peers_.NotReady(options_.required), ", "));
    }
    return !Stopping();
  }

  /// Sleeps until the image may go out; false if that is not to happen any more.
  bool WaitForTurn(int64_t stamp_us) {
    switch (options_.pace) {
      case Pace::kLockstep:
        return WaitUntilConsumed();
      case Pace::kLossless:
        return WaitForRoom();
      case Pace::kRealtime:
        return WaitUntilDue(stamp_us);
    }
    return false;
  }

  bool WaitForRoom() {
    const auto room = [this] { return images_.HasRoom() || Stopping(); };
    while (!bus_.WaitFor(room, kLookAround)) {
      if (bus_.interrupted()) return false;
      ThrowIfAnyoneIsGone();
    }
    return true;
  }

  bool WaitUntilDue(int64_t stamp_us) {
    const Tempo::Clock::time_point due = tempo_.Due(stamp_us, Tempo::Clock::now());
    ThrowIfAnyoneIsGone();
    while (!Stopping()) {
      const auto left = due - Tempo::Clock::now();
      if (left <= left.zero()) return true;
      // Not to the millisecond below: that would end in a busy loop.
      bus_.WaitFor([this] { return Stopping(); },
                   std::min(std::chrono::ceil<std::chrono::milliseconds>(left), kLookAround));
      ThrowIfAnyoneIsGone();
    }
    return false;
  }

  /// Sleeps until the consumers are done with all that was sent; false if interrupted.
  bool WaitUntilConsumed() {
    while (!images_.WaitAllAcked(kLookAround)) {
      if (bus_.interrupted()) return false;
      ThrowIfAnyoneIsGone();
    }
    return true;
  }

  /// What the source broke down with, if it did.
  std::exception_ptr SendImages() {
    while (!Stopping()) {
      std::optional<SourceFrame> frame;
      try {
        frame = source_.Next();
      } catch (const std::exception&) {
        return std::current_exception();
      }
      // Before the time of publishing is taken: it is not to include the wait.
      if (!frame || !WaitForTurn(frame->stamp_us) || Stopping()) break;
      if (!SendImage(*frame)) break;
    }
    return nullptr;
  }

  bool SendImage(const SourceFrame& frame) {
    if (const auto world_from_cam = source_.WorldFromCam(frame.stamp_us)) {
      truth_.Publish({sent_, frame.stamp_us, *world_from_cam});
      options_.on_truth(frame.stamp_us, *world_from_cam);
    }
    ImageFrame image;
    image.frame_seq = sent_;
    image.stamp_us = frame.stamp_us;
    image.published_us = MonotonicMicroseconds();
    image.decode_ms = frame.decode_ms;
    image.pixels = frame.grey;
    if (!images_.Send(pool_ ? pool_->Store(image) : InlineImage(image))) return false;
    ++sent_;
    status_.AddProcessed();
    return true;
  }

  void End() {
    if (WaitUntilConsumed() && images_.SendEnd() && WaitUntilConsumed()) return;
    spdlog::warn("interrupted before the end of the sequence was acknowledged");
  }

  Bus& bus_;
  Peers& peers_;
  StatusReporter& status_;
  ImageSource& source_;
  const PlayOptions options_;
  const std::atomic<bool>& stop_;
  const std::vector<std::string> consumers_;
  Inbox<Command> commands_;
  CameraBeacon camera_;
  Publisher<Truth> truth_;
  StreamWriter<ImageMessage> images_;
  Tempo tempo_;
  std::unique_ptr<ImagePool> pool_;
  int64_t sent_ = 0;
  bool stopped_ = false;
};

}  // namespace

int64_t Play(Bus& bus, Peers& peers, StatusReporter& status, ImageSource& source,
             const PlayOptions& options, const std::atomic<bool>& stop) {
  return Player(bus, peers, status, source, options, stop).Run();
}

}  // namespace vpslam
