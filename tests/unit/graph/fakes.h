// Stand-ins for tracker and mapper that write down in which order things reach them.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "backend/backend_process.h"
#include "frontend/frontend_process.h"

namespace vpslam::test {

/// Its map is the list of keyframes; each comes in parts, as a large change would.
class FakeMapper {
 public:
  static constexpr int kParts = 3;

  MapperCalls Calls() {
    return {[this](const KeyframeProposal& keyframe, const std::function<bool()>& is_urgent) {
              return Process(keyframe, is_urgent);
            },
            [this] { return Snapshot(); }, [this] { return version_; }};
  }

  std::vector<MapDelta> Process(const KeyframeProposal& keyframe,
                                const std::function<bool()>& is_urgent = {}) {
    if (work_ > work_.zero()) std::this_thread::sleep_for(work_);
    asked_ = asked_ || is_urgent;
    urgent_ += is_urgent && is_urgent();
    keyframes_.push_back(keyframe.id);
    std::vector<MapDelta> parts(kParts);
    for (MapDelta& part : parts) {
      part.base_version = version_;
      part.version = ++version_;
    }
    parts.back().keyframes.push_back(State(keyframe.id));
    parts.back().answers = keyframe.id;
    return parts;
  }

  std::vector<MapDelta> Snapshot() {
    ++snapshots_;
    std::vector<MapDelta> parts(2);
    parts[0].snapshot = true;
    parts[0].version = -1;
    parts[1].base_version = -1;
    parts[1].version = version_;
    for (const KeyframeId id : keyframes_) parts[1].keyframes.push_back(State(id));
    return parts;
  }

  std::chrono::milliseconds work_{0};
  bool asked_ = false;  ///< told a way to know whether others wait
  int urgent_ = 0;      ///< keyframes at the end of whose work others waited
  std::vector<KeyframeId> keyframes_;
  int64_t version_ = 0;
  std::atomic<int> snapshots_{0};

 private:
  static KeyframeState State(KeyframeId id) {
    KeyframeState state;
    state.id = id;
    state.map = MapId(0);
    return state;
  }
};

/// Makes every fifth image a keyframe, the first two of them at once.
class FakeTracker final : public TrackerInterface {
 public:
  /// One feature, in which the image's first pixel is kept.
  FrameFeatures Extract(const ImageFrame& image) override {
    FrameFeatures features;
    features.frame_seq = image.frame_seq;
    features.stamp_us = image.stamp_us;
    features.published_us = image.published_us;
    features.decode_ms = image.decode_ms;
    features.features.keypoints.emplace_back();
    features.features.keypoints[0].response = image.pixels.at<uint8_t>(0, 0);
    features.features.descriptors.emplace_back();
    return features;
  }

  TrackerOutput Track(FrameFeatures image) override {
    if (work_ > work_.zero()) std::this_thread::sleep_for(work_);
    frames_of_lines_.push_back(image.lines ? image.lines->frame_seq : -1);
    log_.push_back(fmt::format("image {} {} with {} keyframes", image.frame_seq,
                               image.features.keypoints[0].response, replica_.size()));
    TrackerOutput output;
    FramePose pose;
    pose.frame_seq = image.frame_seq;
    pose.stamp_us = image.stamp_us;
    output.poses.push_back(pose);
    if (image.frame_seq % 5 == 4) {
      if (next_id_ == 0) output.keyframes.push_back(Keyframe(image, KeyframeRole::kMapFirst));
      output.keyframes.push_back(
          Keyframe(image, next_id_ == 1 ? KeyframeRole::kMapSecond : KeyframeRole::kRegular));
    }
    return output;
  }

  TrackerOutput TrackLate() override {
    log_.push_back("late");
    if (on_late_) on_late_();
    return {};
  }

  bool Apply(const MapDelta& delta) override {
    if (refuse_version_ == delta.version && !delta.snapshot) {
      refuse_version_ = -1;
      return false;  // as if the one before had never come
    }
    if (!delta.snapshot && delta.base_version != version_) return false;
    if (delta.snapshot) replica_.clear();
    for (const KeyframeState& k : delta.keyframes) replica_.insert(k.id);
    version_ = delta.version;
    log_.push_back(fmt::format("delta {}", delta.version));
    return true;
  }

  TrackerOutput Finish() override {
    FramePose late;
    late.frame_seq = 0;
    late.live = false;
    TrackerOutput output;
    output.poses.push_back(late);
    return output;
  }

  int64_t map_version() const override { return version_; }
  std::vector<Eigen::Vector2f> TrackedPoints() const override { return {}; }
  void SetUnanswered(int keyframes) override { unanswered_.push_back(keyframes); }

  std::vector<std::string> log_;
  std::function<void()> on_late_;
  std::set<KeyframeId> replica_;
  std::vector<int64_t> frames_of_lines_;  ///< per image; -1: none
  std::vector<int> unanswered_;           ///< per image: keyframes without an answer
  std::chrono::milliseconds work_{0};
  int64_t version_ = 0;
  int64_t refuse_version_ = -1;
  int next_id_ = 0;

 private:
  KeyframeProposal Keyframe(const FrameFeatures& image, KeyframeRole role) {
    KeyframeProposal keyframe;
    keyframe.id = KeyframeId(next_id_++);
    keyframe.role = role;
    keyframe.map = MapId(0);
    keyframe.frame_seq = image.frame_seq;
    return keyframe;
  }
};

}  // namespace vpslam::test
