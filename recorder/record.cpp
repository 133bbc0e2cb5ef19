#include "recorder/record.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "core/messages/command.h"
#include "core/messages/map_request.h"
#include "core/messages/outcome.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"
#include "core/transport/stream_reader.h"
#include "recorder/progress.h"
#include "recorder/results.h"
#include "recorder/run_record.h"

namespace vpslam {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kProgressInterval{200};
/// What comes meanwhile is taken together: nobody waits for it, and each awakening costs.
constexpr milliseconds kRest{50};
/// A request for a snapshot is repeated when nothing fitting came for so long.
constexpr milliseconds kAskAgainAfter{1000};
/// The last statuses, with what each process used in all, follow closely upon the streams' ends.
constexpr milliseconds kWaitForStatuses{1000};
/// Ctrl-C in a terminal reaches all processes at once: the streams then end in good order.
constexpr milliseconds kWaitForEndWhenStopped{1000};
const std::vector<std::string> kSenders = {"player", "frontend", "backend"};

nlohmann::ordered_json DescribeLog(const MessageLog& log) {
  auto channels = nlohmann::ordered_json::object();
  for (const auto& [channel, count] : log.counts()) {
    channels[channel] = {
        {"messages", count.messages}, {"gaps", count.gaps}, {"bytes", count.bytes}};
  }
  return {{"complete", !log.error() && log.left_out() == 0}, {"channels", channels}};
}

}  // namespace

class Recorder::Impl {
 public:
  Impl(Bus& bus, StatusReporter& status, const ResultsFolder& folder, const RunInfo& info,
       std::function<void(const std::string&)> progress,
       const std::optional<MessageLogOptions>& log)
      : bus_(bus),
        status_(status),
        folder_(folder),
        info_(info),
        progress_(std::move(progress)),
        log_(log ? std::make_unique<MessageLog>(bus, *log) : nullptr),
        // Acknowledged on receipt: the recorder holds up nobody.
        poses_(bus, kPoseChannel, "recorder", AckPolicy::kOnReceipt,
               log_ ? log_->PoseTap() : nullptr),
        deltas_(bus, kMapChannel, "recorder", AckPolicy::kOnReceipt,
                log_ ? log_->MapTap() : nullptr),
        statuses_(bus, kStatusChannel, Inbox<ProcessStatus>::kUnbounded),
        commands_(bus, kCommandChannel, Inbox<Command>::kUnbounded),
        previews_(bus, kPreviewChannel, 1),
        outcomes_(bus, kOutcomeChannel, 1),
        requests_(bus, kMapRequestChannel),
        peers_(bus) {}

  bool Run(const std::atomic<bool>& stop) {
    status_.SetState(ProcessState::kReady);
    std::exception_ptr broken;
    try {
      Follow(stop);
    } catch (...) {
      broken = std::current_exception();  // what came until then is not lost
    }
    const bool complete = Ended();
    bus_.WaitFor(
        [this] {
          TakeStatuses();
          return OthersFinished();
        },
        kWaitForStatuses);
    if (log_) log_->Close();
    Write();
    if (broken) std::rethrow_exception(broken);
    ShowProgress(true);
    if (log_ && log_->error()) throw std::runtime_error(*log_->error());
    return complete;
  }

 private:
  bool Ended() const {
    return poses_.Ended() && deltas_.Ended() && (!log_ || log_->StreamsEnded());
  }
  void Follow(const std::atomic<bool>& stop) {
    std::optional<Clock::time_point> give_up;
    UnheardNotice notice;
    while (!Ended() && !bus_.interrupted()) {
      notice.Look(bus_, peers_, kSenders);
      const bool in_vain = IsLeftAlone();
      if (!give_up && (stop || stopped_ || in_vain)) {
        give_up = Clock::now() + (run_.frames().empty() ? milliseconds(0) : kWaitForEndWhenStopped);
      }
      if (give_up && Clock::now() >= *give_up) break;
      bus_.WaitFor([&] { return HasWork() || Ended() || (stop && !give_up); }, kProgressInterval);
      Work();
      ShowProgress(false);
      std::this_thread::sleep_for(kRest);
    }
    Work();  // what was received, and acknowledged, before the end was decided
  }

  /// Those from whom poses and map come have gone without ending their streams.
  bool IsLeftAlone() const {
    bool any_gone = false;
    for (const std::string& process : kSenders) {
      const bool gone = peers_.WhyGone(process).has_value();
      if (!gone && peers_.NeverHeard({process}).empty()) return false;
      any_gone |= gone;
    }
    return any_gone;
  }

  bool HasWork() const {
    return poses_.HasMessage() || deltas_.HasMessage() || statuses_.HasMessage() ||
           commands_.HasMessage();
  }

  void Work() {
    while (const auto item = poses_.TryTake()) {
      if (run_.frames().empty()) status_.SetState(ProcessState::kRunning);
      run_.Add(item->value);
      newest_pose_ = Clock::now();
      status_.AddProcessed();
    }
    while (const auto item = deltas_.TryTake()) Apply(item->value);
    while (const auto preview = previews_.TryTake()) run_.Add(preview->value);
    TakeStatuses();
    while (const auto command = commands_.TryTake()) Obey(command->value);
  }

  void Apply(const MapDelta& delta) {
    if (run_.Apply(delta)) {
      asked_.reset();
      return;
    }
    const auto now = Clock::now();
    if (asked_ && now < *asked_ + kAskAgainAfter) return;
    asked_ = now;
    spdlog::info("map delta {} -> {} does not fit version {}: asking for a snapshot",
                 delta.base_version, delta.version, run_.map().version());
    // Within a snapshot, which this one may have come into, versions are below 0.
    requests_.Publish({"recorder", std::max<int64_t>(run_.map().version(), 0)});
  }

  void TakeStatuses() {
    while (const auto message = statuses_.TryTake()) run_.Add(message->value);
    while (const auto message = outcomes_.TryTake()) run_.Add(message->value);
  }

  bool OthersFinished() const {
    for (const auto& [key, status] : run_.processes()) {
      if (status.process != "recorder" && status.state != ProcessState::kFinished &&
          status.state != ProcessState::kFailed) {
        return false;
      }
    }
    return true;
  }

  void Obey(const Command& command) {
    if (!command.target.empty() && command.target != "recorder") return;
    if (command.action == CommandAction::kStop) {
      // Without a target it concerns the player, and the streams will end.
      stopped_ |= command.target == "recorder";
    } else if (command.action == CommandAction::kSaveNow) {
      try {
        Write();
      } catch (const std::exception& e) {
        spdlog::error("{}", e.what());  // the run goes on; there may be space in the end
      }
    }
  }

  void Write() {
    run_.Add(status_.Snapshot());
    if (log_) info_.log = DescribeLog(*log_);
    WriteResults(run_, info_, folder_);
    spdlog::info("results of {} frames are in {}", run_.frames().size(), folder_.path());
  }

  void ShowProgress(bool now) {
    if (!progress_ || (!now && Clock::now() < shown_ + kProgressInterval)) return;
    shown_ = Clock::now();
    const double idle_s = std::chrono::duration<double>(shown_ - newest_pose_).count();
    progress_(ProgressLine(run_, now ? 0 : idle_s));
  }

  Bus& bus_;
  StatusReporter& status_;
  const ResultsFolder folder_;
  RunInfo info_;
  const std::function<void(const std::string&)> progress_;
  std::unique_ptr<MessageLog> log_;  // before the streams that it taps
  StreamReader<FramePose> poses_;
  StreamReader<MapDelta> deltas_;
  Inbox<ProcessStatus> statuses_;
  Inbox<Command> commands_;
  Inbox<Preview> previews_;
  Inbox<Outcome> outcomes_;
  Publisher<MapRequest> requests_;
  Peers peers_;
  RunRecord run_;
  std::optional<Clock::time_point> asked_;  ///< when a snapshot was asked for that has not come
  Clock::time_point shown_, newest_pose_;
  bool stopped_ = false;
};

Recorder::Recorder(Bus& bus, StatusReporter& status, const ResultsFolder& folder,
                   const RunInfo& info, std::function<void(const std::string&)> progress,
                   const std::optional<MessageLogOptions>& log)
    : impl_(std::make_unique<Impl>(bus, status, folder, info, std::move(progress), log)) {}

Recorder::~Recorder() = default;

bool Recorder::Run(const std::atomic<bool>& stop) { return impl_->Run(stop); }

}  // namespace vpslam
