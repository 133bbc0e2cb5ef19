#include "player/decode_ahead.h"

#include <algorithm>
#include <utility>

namespace vpslam {

DecodeAhead::DecodeAhead(std::unique_ptr<ImageSource> source, int capacity)
    : source_(std::move(source)),
      capacity_(static_cast<size_t>(std::max(1, capacity))),
      thread_([this] { Run(); }) {}

DecodeAhead::~DecodeAhead() { Stop(); }

void DecodeAhead::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DecodeAhead::Run() {
  for (;;) {
    std::optional<SourceFrame> frame;
    std::exception_ptr error;
    try {
      frame = source_->Next();
    } catch (...) {
      error = std::current_exception();
    }
    std::unique_lock lock(mutex_);
    if (!frame) {
      ended_ = true;
      error_ = error;
      changed_.notify_all();
      return;
    }
    changed_.wait(lock, [this] { return stop_ || frames_.size() < capacity_; });
    if (stop_) return;
    frames_.push_back(std::move(*frame));
    changed_.notify_all();
  }
}

std::optional<SourceFrame> DecodeAhead::Next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stop_ || ended_ || !frames_.empty(); });
  if (!frames_.empty()) {
    SourceFrame frame = std::move(frames_.front());
    frames_.pop_front();
    changed_.notify_all();
    return frame;
  }
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  return std::nullopt;
}

SourceReport DecodeAhead::Report() {
  Stop();
  return source_->Report();
}

}  // namespace vpslam
