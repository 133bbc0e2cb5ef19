// The backend as a process: takes keyframe proposals from the graph, gives them to a mapper, and
// publishes the changes of the map; serves snapshots to replicas that missed something.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/pace.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/map_delta.h"
#include "core/messages/map_request.h"
#include "core/transport/camera_link.h"
#include "core/transport/inbox.h"
#include "core/transport/peers.h"
#include "core/transport/status_reporter.h"
#include "core/transport/stream_reader.h"
#include "core/transport/stream_writer.h"

namespace vpslam {

/// What the loop needs of a mapper; see backend/mapper.h for what each does.
struct MapperCalls {
  /// `is_urgent` is empty where the result must not depend on time.
  std::function<std::vector<MapDelta>(const KeyframeProposal&, const std::function<bool()>&)>
      process;
  std::function<std::vector<MapDelta>()> snapshot;
  std::function<int64_t()> version;
};

/// Called once, when the camera is known.
using MakeMapper = std::function<MapperCalls(const Camera&)>;

class BackendProcess {
 public:
  /// Subscribes. `required` names the processes that acknowledge MAP.
  BackendProcess(Bus& bus, Peers& peers, StatusReporter& status,
                 const std::vector<std::string>& required, Pace pace, MakeMapper make_mapper);

  /// Until the stream of keyframes has ended and everything is acknowledged, or the bus is
  /// interrupted. Throws PeerGoneError.
  void Run();

 private:
  bool Work(const KeyframeProposal& keyframe);
  bool SendAll(const std::vector<MapDelta>& deltas);
  bool AnswerRequests();

  Bus& bus_;
  Peers& peers_;
  StatusReporter& status_;
  const Pace pace_;
  const MakeMapper make_mapper_;
  std::optional<MapperCalls> mapper_;

  CameraReceiver camera_;
  StreamReader<KeyframeProposal> keyframes_;
  Inbox<MapRequest> requests_;
  StreamWriter<MapDelta> deltas_;
};

}  // namespace vpslam
