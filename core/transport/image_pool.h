// Images through POSIX shared memory: a ring of slots that one process writes and any reads.
//
// A slot carries a generation, odd while it is written. A reader copies the pixels out and looks at
// the generation again (a seqlock), so that a slot which was reused in between is noticed. Slots
// are reused in turn: with more slots than a stream's window, one is reused only after every
// required consumer is done with it, because Send(n) returned for the message before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/messages/image_frame.h"
#include "core/transport/image_message.h"

namespace vpslam {

/// "/vpslam-<session>": the launcher knows it, too, and unlinks it after the run.
std::string ImageSegmentName(int64_t session);

/// The writer's side; unlinks the segment in the end.
class ImagePool {
 public:
  /// Throws std::runtime_error, naming fault and remedy; a stale segment of this name is replaced.
  ImagePool(const std::string& segment, int slots, std::size_t slot_bytes);
  ~ImagePool();
  ImagePool(const ImagePool&) = delete;
  ImagePool& operator=(const ImagePool&) = delete;

  /// Copies the pixels (CV_8UC1) into the next slot. Throws std::runtime_error if they do not fit.
  ImageMessage Store(const ImageFrame& frame);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// The reader's side: maps a segment when it sees its name first.
class ImageFetcher {
 public:
  ImageFetcher();
  ~ImageFetcher();
  ImageFetcher(const ImageFetcher&) = delete;
  ImageFetcher& operator=(const ImageFetcher&) = delete;

  /// The image with pixels of its own; nullopt, with the reason, if the segment is absent or not
  /// one of ours, or the slot was written anew meanwhile.
  std::optional<ImageFrame> Fetch(const ImageMessage& message, std::string* why);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
