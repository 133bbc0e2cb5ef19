#include "core/transport/camera_link.h"

#include <spdlog/spdlog.h>

#include "core/transport/channels.h"
#include "core/transport/stream_writer.h"

namespace vpslam {
namespace {
constexpr const char* kPlayer = "player";
constexpr std::chrono::milliseconds kPeriod{1000};
constexpr std::size_t kCommandCapacity = 16;
}  // namespace

CameraBeacon::CameraBeacon(Bus& bus, const Camera& camera)
    : camera_(camera),
      publisher_(bus, kCameraChannel),
      commands_(bus, kCommandChannel, kCommandCapacity),
      last_published_(std::chrono::steady_clock::now()) {
  publisher_.Publish(camera_);
  timer_ = bus.OnTick([this] { Tick(); });
}

void CameraBeacon::Tick() {
  const auto now = std::chrono::steady_clock::now();
  bool due = now - last_published_ >= kPeriod;
  while (const auto command = commands_.TryTake()) {
    due |= command->value.action == CommandAction::kSendCamera;
  }
  if (!due) return;
  last_published_ = now;
  publisher_.Publish(camera_);
}

CameraReceiver::CameraReceiver(Bus& bus)
    : bus_(bus),
      cameras_(bus, kCameraChannel, 1, /*repeats=*/true),
      commands_(bus, kCommandChannel) {}

std::optional<Camera> CameraReceiver::TryTake() {
  auto message = cameras_.TryTake();
  if (!message) return std::nullopt;
  return message->value;
}

std::optional<Camera> CameraReceiver::Wait(const Peers& peers) {
  UnheardNotice notice;
  while (!bus_.interrupted()) {
    if (auto camera = TryTake()) return camera;
    if (const auto why = peers.WhyGone(kPlayer)) {
      if (peers.Get(kPlayer)->state != ProcessState::kFinished) throw PeerGoneError(*why);
      spdlog::info("{}, and played nothing", *why);
      return std::nullopt;
    }
    notice.Look(bus_, peers, {kPlayer});
    commands_.Publish({kPlayer, CommandAction::kSendCamera});
    bus_.WaitFor([&] { return cameras_.HasMessage() || peers.WhyGone(kPlayer); }, kPeriod);
  }
  return std::nullopt;
}

}  // namespace vpslam
