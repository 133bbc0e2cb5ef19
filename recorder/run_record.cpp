#include "recorder/run_record.h"

#include <algorithm>
#include <cmath>

namespace vpslam {

void RunRecord::Add(const FramePose& pose) {
  FrameRecord& frame = frames_[pose.frame_seq];
  frame.last = pose;
  if (pose.live && !frame.live) frame.live = pose;
}

void RunRecord::Add(const ProcessStatus& status) {
  processes_[{status.process, status.pid}] = status;
}

bool RunRecord::Apply(const MapDelta& delta) {
  if (!map_.Apply(delta)) return false;
  for (const KeyframeState& k : delta.keyframes) {
    origins_[k.id] = {k.frame_seq, k.stamp_us};
    // The first view of a map is answered before it is in the map.
    if (const auto answered = keyframes_.find(k.id); answered != keyframes_.end()) {
      answered->second.frame_seq = k.frame_seq;
      answered->second.stamp_us = k.stamp_us;
    }
  }
  if (delta.answers.IsValid()) {
    const Origin origin = origins_[delta.answers];
    keyframes_[delta.answers] = {delta.answers, origin.frame_seq, origin.stamp_us, delta.times};
  }
  return true;
}

int64_t RunRecord::frames_in() const {
  int64_t published = 0;
  for (const auto& [key, status] : processes_) {
    if (status.process == "player") published += status.processed;
  }
  return std::max(published, frames_.empty() ? 0 : frames_.rbegin()->first + 1);
}

double RunRecord::wall_s() const {
  double begin_us = 0, end_us = 0;
  bool first = true;
  for (const auto& [seq, frame] : frames_) {
    if (!frame.live || !std::isfinite(frame.live->times.total_ms)) continue;
    const auto published_us = static_cast<double>(frame.live->image_published_us);
    const double done_us = published_us + 1e3 * frame.live->times.total_ms;
    begin_us = first ? published_us : std::min(begin_us, published_us);
    end_us = first ? done_us : std::max(end_us, done_us);
    first = false;
  }
  return 1e-6 * (end_us - begin_us);
}

}  // namespace vpslam
