#include "backend/backend_process.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "core/transport/channels.h"

namespace vpslam {
namespace {

constexpr const char* kName = "backend";
constexpr std::chrono::hours kForever{24 * 365};
constexpr std::size_t kRequestCapacity = 16;
// Parts of up to 48 kB: two of them fit the smallest receive buffer in use.
constexpr int kMapWindow = 2;

StreamWriterOptions Window(int window) {
  StreamWriterOptions options;
  options.window = window;
  return options;
}

}  // namespace

BackendProcess::BackendProcess(Bus& bus, Peers& peers, StatusReporter& status,
                               const std::vector<std::string>& required, Pace pace,
                               MakeMapper make_mapper)
    : bus_(bus),
      peers_(peers),
      status_(status),
      pace_(pace),
      make_mapper_(std::move(make_mapper)),
      camera_(bus),
      keyframes_(bus, kKeyframeChannel, kName, AckPolicy::kOnReceipt),
      requests_(bus, kMapRequestChannel, kRequestCapacity),
      deltas_(bus, kMapChannel, RequiredConsumers(kMapConsumers, required), Window(kMapWindow)) {}

void BackendProcess::Run() {
  status_.SetState(ProcessState::kReady);
  const std::optional<Camera> camera = camera_.Wait(peers_);
  if (!camera) return;
  mapper_ = make_mapper_(*camera);
  status_.SetState(ProcessState::kRunning);
  const auto queue = status_.WatchQueue([this] { return static_cast<int64_t>(keyframes_.size()); });
  while (true) {
    const auto news = [this] { return keyframes_.HasNews() || requests_.HasMessage(); };
    if (!peers_.WaitFor(news, {"frontend"})) return;
    if (!AnswerRequests()) return;
    if (keyframes_.Ended()) break;
    const auto item = keyframes_.TryTake();
    if (!item) continue;
    if (!Work(item->value)) return;
  }
  if (deltas_.SendEnd() && deltas_.WaitAllAcked(kForever)) spdlog::info("end of the sequence");
}

bool BackendProcess::AnswerRequests() {
  bool wanted = false;
  while (const auto request = requests_.TryTake()) {
    // Requests are repeated; one that is of an older state than the answer to it is served again.
    if (request->value.map_version >= mapper_->version()) continue;
    spdlog::info("{} has version {} of the map and gets a snapshot of {}", request->value.process,
                 request->value.map_version, mapper_->version());
    wanted = true;
  }
  if (!wanted) return true;
  // A frontend that was started again gives ids above those that it is told of: what its forerunner
  // sent comes first.
  while (const auto item = keyframes_.TryTake()) {
    if (!Work(item->value)) return false;
  }
  return SendAll(mapper_->snapshot());
}

bool BackendProcess::Work(const KeyframeProposal& keyframe) {
  // The tracker proposes another keyframe before it has an answer only if it needs new points, or
  // beside one of an earlier frame.
  const auto next_waits = [this] { return keyframes_.HasMessage(); };
  const auto is_urgent =
      pace_ == Pace::kRealtime ? std::function<bool()>(next_waits) : std::function<bool()>();
  if (!SendAll(mapper_->process(keyframe, is_urgent))) return false;
  status_.AddProcessed();
  return true;
}

bool BackendProcess::SendAll(const std::vector<MapDelta>& deltas) {
  return std::all_of(deltas.begin(), deltas.end(),
                     [this](const MapDelta& delta) { return deltas_.Send(delta); });
}

}  // namespace vpslam
