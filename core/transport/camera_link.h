// The camera message: LCM latches nothing, so the player repeats it, and others may ask for it.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "core/geometry/camera.h"
#include "core/messages/command.h"
#include "core/transport/bus.h"
#include "core/transport/inbox.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"

namespace vpslam {

/// The player's side: publishes the camera at once, at 1 Hz and on request.
class CameraBeacon {
 public:
  CameraBeacon(Bus& bus, const Camera& camera);

 private:
  void Tick();

  const Camera camera_;
  Publisher<Camera> publisher_;
  Inbox<Command> commands_;
  std::chrono::steady_clock::time_point last_published_;
  Bus::Registration timer_;
};

/// Everyone else's side: subscribed from its construction on.
class CameraReceiver {
 public:
  explicit CameraReceiver(Bus& bus);

  /// Waits for the camera and asks for it once a second. nullopt if interrupted, or if the player
  /// ended without having played anything; throws PeerGoneError if it failed or fell silent.
  std::optional<Camera> Wait(const Peers& peers);
  /// The camera, if it came already.
  std::optional<Camera> TryTake();

 private:
  Bus& bus_;
  Inbox<Camera> cameras_;
  Publisher<Command> commands_;
};

}  // namespace vpslam
