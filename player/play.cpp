#include "player/play.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "core/geometry/camera_plausibility.h"
#include "core/messages/command.h"
#include "core/messages/outcome.h"
#include "core/messages/truth.h"
#include "core/transport/camera_link.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"
#include "core/transport/publisher.h"
#include "core/transport/receive_buffer.h"
#include "core/transport/stream_writer.h"
#include "player/frame_sender.h"
#include "player/gap_bound.h"
#include "player/outcome.h"
#include "player/play_control.h"
#include "player/tempo.h"

namespace vpslam {
namespace {

constexpr std::chrono::seconds kTellWaitingAfter{5};
/// Stopped before all were there: those that are hear of the end, but nobody is waited for.
constexpr std::chrono::seconds kPatienceWithTheUnready{1};
/// How often a wait looks at whether it still makes sense.
constexpr std::chrono::milliseconds kLookAround{200};
constexpr std::chrono::hours kForever{24 * 365};
/// Less of an image may be unusable without a word, as the corners of a fit from few pictures.
constexpr double kWholeImage = 0.98;

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
        commands_(bus, kCommandChannel, Inbox<Command>::kUnbounded),
        truths_(bus, kTruthChannel, AndRecorderIf(options.record != "none", {}),
                TruthWindow(options.pace)),
        frames_(MakeFrameSender(bus, source, options)),
        outcomes_(bus, kOutcomeChannel),
        tempo_(source.IsLive()) {}

  int64_t Run() {
    status_.SetState(ProcessState::kReady);
    if (!WaitForConsumers()) {
      TellOutcome("stopped");
      frames_->SendEnd();
      truths_.SendEnd();
      frames_->WaitAllAcked(kPatienceWithTheUnready);
      return 0;
    }
    // Not before: to a graph that has a player already this would be another one's camera.
    camera_.emplace(bus_, source_.camera());
    warning_ = Warning();
    TellControl();
    const std::exception_ptr broken = SendFrames();
    TellOutcome(broken ? "the source broke down" : stopped_ ? "stopped" : "not sent");
    if (tempo_.restarts() > 0) {
      spdlog::warn("late by more than {} s {} times, and went on from there",
                   std::chrono::duration<double>(Tempo::kMaxDebt).count(), tempo_.restarts());
    }
    End();
    outcomes_.Publish(outcome_);  // again, as nobody acknowledges it
    if (broken) std::rethrow_exception(broken);
    return sent_;
  }

 private:
  static StreamWriterOptions TruthWindow(Pace pace) {
    StreamWriterOptions options;
    options.window = 64;
    options.drop_oldest = pace == Pace::kRealtime;
    return options;
  }

  /// What a person had better know from the start; empty if there is nothing.
  std::string Warning() const {
    const std::string notice = source_.Notice(), loss = LossWarning();
    if (!notice.empty()) spdlog::info("{}", notice);
    return notice + (notice.empty() || loss.empty() ? "" : "; ") + loss;
  }

  std::string LossWarning() const {
    const std::optional<int> asked = AskedReceiveBuffer(bus_.url());
    if (!options_.inline_pixels || source_.HasFeatures() || !asked) return {};
    const Camera& c = source_.camera();
    const auto why = WhyInlineImagesGetLost(*asked, GrantedReceiveBuffer(*asked),
                                            static_cast<size_t>(c.width) * c.height,
                                            FrameWindow(options_.pace).window);
    if (why) spdlog::warn("{}", *why);
    return why.value_or("");
  }

  bool Stopping() {
    while (const auto command = commands_.TryTake()) {
      const Command& c = command->value;
      if (!c.target.empty() && c.target != "player") continue;
      stopped_ |= c.action == CommandAction::kStop;
      if (!control_.Obey(c)) continue;
      tempo_.StartAnew();
      TellControl();
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
      const auto unready = fmt::format(
          "waiting for {} on {}", fmt::join(peers_.NotReady(options_.required), ", "), bus_.url());
      spdlog::info("{}", unready);
      status_.SetState(ProcessState::kReady, unready);
    }
    return !Stopping();
  }

  void TellControl() {
    if (control_.paused()) {
      status_.SetState(ProcessState::kRunning, fmt::format("paused before frame {}", sent_));
    } else if (control_.rate() > 0) {
      status_.SetState(ProcessState::kRunning, fmt::format("rate {:g}", control_.rate()));
    } else {
      status_.SetState(ProcessState::kRunning, warning_);
    }
  }

  /// A gap that is not waited for as long as it is, in the progress line and the log.
  void TellGap() {
    const bool waits = options_.pace == Pace::kRealtime || control_.rate() > 0;
    if (gaps_.newest_gap_us() == 0 || !waits) return;
    const std::string line = fmt::format(
        "a gap of {:g} s in the time stamps, before image {}, is played as one of {:g} s",
        1e-6 * static_cast<double>(gaps_.newest_gap_us()), sent_, 1e-6 * GapBound::kLongest_us);
    spdlog::warn("{}", line);
    status_.SetState(ProcessState::kRunning, line);
  }

  void TellOutcome(const std::string& why_not_sent) {
    SourceReport report = source_.Report();
    if (const double usable = UsableShare(source_.camera()); usable < kWholeImage) {
      report.notes.push_back(
          fmt::format("the distortion of the calibration leaves {:.0f} % of the "
                      "image usable; is it that of this lens?",
                      100 * usable));
    }
    const auto outcome = DescribeOutcome(report, sent_, why_not_sent);
    outcome_.json = OutcomeText(outcome);
    outcomes_.Publish(outcome_);
    const bool all = outcome["skipped"].empty() && !outcome.contains("end_missing");
    spdlog::log(all ? spdlog::level::info : spdlog::level::warn, "{}", OutcomeLine(outcome));
  }

  /// Sleeps while paused, and until the rate lets the frame out; false if it is not to go out.
  bool WaitForControl(int64_t time_us) {
    return SleepUntil([&] { return control_.Due(time_us, PlayControl::Clock::now()); });
  }

  /// False if the frame is not to go out. A pause may come while its turn is waited for.
  bool WaitToSend(int64_t time_us) {
    do {
      if (!WaitForControl(time_us) || !WaitForTurn(time_us) || Stopping()) return false;
    } while (control_.paused());
    return true;
  }

  /// `due_at` says when, as things stand; nullopt: not yet known. False if stopped.
  template <class Due>
  bool SleepUntil(const Due& due_at) {
    using Clock = PlayControl::Clock;
    while (!Stopping()) {
      const std::optional<Clock::time_point> due = due_at();
      const auto left = due ? *due - Clock::now() : Clock::duration(kLookAround);
      if (left <= left.zero()) return true;
      const int64_t changes = control_.changes();
      // Not to the millisecond below: that would end in a busy loop.
      bus_.WaitFor([&] { return Stopping() || control_.changes() != changes; },
                   std::min(std::chrono::ceil<std::chrono::milliseconds>(left), kLookAround));
      ThrowIfAnyoneIsGone();
    }
    return false;
  }

  /// Sleeps until the pace lets the frame out; false if that is not to happen any more.
  bool WaitForTurn(int64_t time_us) {
    switch (options_.pace) {
      case Pace::kLockstep:
        return WaitUntilConsumed();
      case Pace::kLossless:
        return WaitForRoom();
      case Pace::kRealtime:
        // A rate that a person asked for takes the place of the time stamps' tempo.
        return control_.rate() > 0 || WaitUntilDue(time_us);
    }
    return false;
  }

  bool WaitForRoom() {
    const auto room = [this] { return frames_->HasRoom() || Stopping(); };
    while (!bus_.WaitFor(room, kLookAround)) {
      if (bus_.interrupted()) return false;
      ThrowIfAnyoneIsGone();
    }
    return true;
  }

  bool WaitUntilDue(int64_t time_us) {
    const Tempo::Clock::time_point due = tempo_.Due(time_us, Tempo::Clock::now());
    ThrowIfAnyoneIsGone();
    return SleepUntil([due] { return due; });
  }

  /// Sleeps until the consumers are done with all that was sent; false if interrupted.
  bool WaitUntilConsumed() {
    while (!frames_->WaitAllAcked(kLookAround)) {
      if (bus_.interrupted()) return false;
      ThrowIfAnyoneIsGone();
    }
    return true;
  }

  /// What the source broke down with, if it did.
  std::exception_ptr SendFrames() {
    while (!Stopping()) {
      std::optional<SourceFrame> frame;
      bool ready = false;
      try {
        ready = source_.WaitReady(kLookAround);
        if (ready) frame = source_.Next();
      } catch (const std::exception&) {
        return std::current_exception();
      }
      if (!ready) {
        ThrowIfAnyoneIsGone();
        continue;
      }
      if (!frame) break;
      const int64_t time_us = gaps_.TimeOf(frame->stamp_us);
      TellGap();
      // Before the time of publishing is taken: it is not to include the wait.
      if (!WaitToSend(time_us)) break;
      if (!SendFrame(*frame)) break;
    }
    return nullptr;
  }

  bool SendFrame(const SourceFrame& frame) {
    if (const auto world_from_cam = source_.WorldFromCam(frame.stamp_us)) {
      if (!truths_.Send({sent_, frame.stamp_us, *world_from_cam})) return false;
      options_.on_truth(frame.stamp_us, *world_from_cam);
    }
    if (!frames_->Send(frame, sent_)) return false;
    ++sent_;
    control_.Sent();
    if (control_.paused()) TellControl();
    status_.AddProcessed();
    return true;
  }

  void End() {
    // From the end on consumers may be gone, and rightly so: their acknowledgements tell.
    if (WaitUntilConsumed() && frames_->SendEnd() && frames_->WaitAllAcked(kForever) &&
        truths_.SendEnd() && truths_.WaitAllAcked(kForever)) {
      return;
    }
    spdlog::warn("interrupted before the end of the sequence was acknowledged");
  }

  Bus& bus_;
  Peers& peers_;
  StatusReporter& status_;
  ImageSource& source_;
  const PlayOptions options_;
  const std::atomic<bool>& stop_;
  Inbox<Command> commands_;
  std::optional<CameraBeacon> camera_;
  StreamWriter<Truth> truths_;
  std::unique_ptr<FrameSender> frames_;
  Publisher<Outcome> outcomes_;
  Outcome outcome_;
  PlayControl control_;
  GapBound gaps_;
  Tempo tempo_;
  std::string warning_;
  int64_t sent_ = 0;
  bool stopped_ = false;
};

}  // namespace

int64_t Play(Bus& bus, Peers& peers, StatusReporter& status, ImageSource& source,
             const PlayOptions& options, const std::atomic<bool>& stop) {
  return Player(bus, peers, status, source, options, stop).Run();
}

}  // namespace vpslam
