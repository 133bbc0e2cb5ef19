// Reads a source ahead of time in a thread of its own, so that decoding and tracking overlap.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "player/image_source.h"

namespace vpslam {

/// Delivers what the source inside delivers, in the same order; an exception comes when its turn
/// comes, behind the good frames before it.
class DecodeAhead : public ImageSource {
 public:
  /// Holds at most `capacity` decoded frames.
  explicit DecodeAhead(std::unique_ptr<ImageSource> source, int capacity = 4);
  /// Waits for the frame that is being decoded.
  ~DecodeAhead() override;

  const Camera& camera() const override { return source_->camera(); }
  bool HasFeatures() const override { return source_->HasFeatures(); }
  std::optional<SourceFrame> Next() override;
  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    return source_->WorldFromCam(stamp_us);
  }
  /// Ends reading ahead.
  SourceReport Report() override;

 private:
  void Run();
  void Stop();

  std::unique_ptr<ImageSource> source_;
  const size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<SourceFrame> frames_;
  bool ended_ = false;
  bool stop_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace vpslam
