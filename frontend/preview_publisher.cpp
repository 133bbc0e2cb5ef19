#include "frontend/preview_publisher.h"

#include <exception>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "core/messages/command.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"

namespace vpslam {

PreviewPublisher::PreviewPublisher(Bus& bus, const Camera& camera, bool always)
    : publisher_(bus, kPreviewChannel), painter_(camera), always_(always) {
  thread_ = std::thread([this] { Run(); });
  commands_ = bus.Subscribe(kCommandChannel, [this](std::span<const uint8_t> b) { OnCommand(b); });
}

PreviewPublisher::~PreviewPublisher() {
  commands_.Cancel();
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PreviewPublisher::Offer(const std::function<PreviewScene()>& make_scene) {
  const auto now = Clock::now();
  if (!always_ && now.time_since_epoch().count() >= asked_until_) return;
  if (now < last_ + kPeriod) return;
  {
    const std::lock_guard lock(mutex_);
    if (scene_) return;  // the thread has not come to the one before
    scene_ = make_scene();
  }
  last_ = now;
  changed_.notify_all();
}

// What does not decode is counted by others who read the channel.
void PreviewPublisher::OnCommand(std::span<const uint8_t> bytes) {
  std::string why;
  const auto message = Decode<Command>(bytes, &why);
  if (!message || message->header.last || message->value.action != CommandAction::kShow) return;
  if (!message->value.target.empty() && message->value.target != "frontend") return;
  asked_until_ = (Clock::now() + kAskedFor).time_since_epoch().count();
}

void PreviewPublisher::Run() {
  constexpr int kNice = 10;  // tracking comes first; of this thread alone, on Linux
  setpriority(PRIO_PROCESS, 0, kNice);
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || scene_; });
    if (stop_) return;
    const PreviewScene scene = *std::exchange(scene_, std::nullopt);
    lock.unlock();
    try {
      const std::vector<uint8_t> jpeg = CompressToFit(painter_.Paint(scene), Preview::kMaxBytes);
      if (!jpeg.empty()) publisher_.Publish({scene.frame_seq, scene.stamp_us, jpeg});
    } catch (const std::exception& e) {
      spdlog::warn("frame {} gets no preview: {}", scene.frame_seq, e.what());
    }
    lock.lock();
  }
}

}  // namespace vpslam
