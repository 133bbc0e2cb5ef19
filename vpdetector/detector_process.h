// The detector as a process: answers requests for the lines of images.
//
// Which of several instances is asked for which image is the business of who needs the lines
// (frontend/line_dispatch.h). An instance keeps the messages of the last images, so that it does
// not matter whether image or request comes first, and answers its requests in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "core/features/line_set.h"
#include "core/transport/bus.h"
#include "core/transport/camera_link.h"
#include "core/transport/image_message.h"
#include "core/transport/image_pool.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"
#include "core/transport/status_reporter.h"
#include "vpdetector/detector.h"

namespace vpslam {

class DetectorProcess {
 public:
  static constexpr const char* kName = "vpdetector";

  /// Subscribes.
  DetectorProcess(Bus& bus, Peers& peers, StatusReporter& status, const DetectorOptions& options);

  /// Until the images have ended, COMMAND kStop came for the vpdetector, or the bus is interrupted.
  /// Throws PeerGoneError if the player falls silent, std::invalid_argument if camera or options do
  /// not validate, std::runtime_error if images cannot be read.
  void Run();

 private:
  static constexpr std::size_t kKeptImages = 8;
  static constexpr std::size_t kMaxWanted = 16;
  /// So many images one after the other that cannot be fetched: none ever will.
  static constexpr int kMaxUnreadable = 10;

  void OnImage(std::span<const uint8_t> bytes);
  void OnRequest(std::span<const uint8_t> bytes);
  void OnCommand(std::span<const uint8_t> bytes);
  struct Wanted {
    int64_t image_session;
    int64_t frame_seq;
    bool operator==(const Wanted&) const = default;
  };
  bool IsHere(const Wanted& wanted) const;
  /// The first image that was asked for and has come; it is in work from then on.
  std::optional<ImageMessage> NextWork();
  bool HasWork() const;
  bool SequenceIsOver() const;
  void Work(const Detector& detector, const ImageMessage& message);
  void Answer(LineSet lines);

  Bus& bus_;
  Peers& peers_;
  StatusReporter& status_;
  const DetectorOptions options_;
  CameraReceiver camera_;
  ImageFetcher fetcher_;
  Publisher<LineSet> answers_;
  int unreadable_ = 0;

  mutable std::mutex mutex_;  ///< of what follows
  int64_t image_session_ = 0;
  std::map<int64_t, ImageMessage> images_;  ///< by frame_seq
  std::deque<Wanted> wanted_;               ///< in the order of asking
  std::optional<Wanted> in_work_;
  bool ended_ = false;
  Bus::Registration image_registration_, request_registration_, command_registration_;
};

}  // namespace vpslam
