// Publishes previews while somebody asks for them, in a thread of its own, a few per second: the
// tracking thread only hands over what to paint.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "core/messages/preview.h"
#include "core/transport/bus.h"
#include "core/transport/publisher.h"
#include "frontend/preview_painter.h"

namespace vpslam {

class PreviewPublisher {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kPeriod{200};  ///< at least, between two pictures
  /// One command asks for so long; who looks on repeats it.
  static constexpr std::chrono::seconds kAskedFor{6};

  /// `always`: without being asked.
  PreviewPublisher(Bus& bus, const Camera& camera, bool always);
  ~PreviewPublisher();

  /// Publishes what `make_scene` says if a picture is wanted now; it is not called otherwise.
  void Offer(const std::function<PreviewScene()>& make_scene);

 private:
  void OnCommand(std::span<const uint8_t> bytes);
  void Run();

  Publisher<Preview> publisher_;
  PreviewPainter painter_;  ///< of the thread
  const bool always_;
  std::atomic<Clock::rep> asked_until_{0};
  Clock::time_point last_;  ///< of the tracking thread, who offers

  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::optional<PreviewScene> scene_;
  bool stop_ = false;
  std::thread thread_;
  Bus::Registration commands_;
};

}  // namespace vpslam
