#include "frontend/tracker.h"

#include <utility>

#include "core/base/stopwatch.h"
#include "core/features/octave_check.h"
#include "core/features/orb_extractor.h"
#include "core/map/map_replica.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/keyframe_proposer.h"
#include "frontend/late_work.h"
#include "frontend/live_tracker.h"

namespace vpslam {
namespace {

OrbOptions WithFeatures(OrbOptions orb, int num_features) {
  orb.num_features = num_features;
  return orb;
}

}  // namespace

class Tracker::Impl {
 public:
  Impl(const Camera& camera, const TrackerOptions& options, uint64_t seed)
      : camera_(camera),
        bounds_(camera.UndistortedBounds()),
        options_(options),
        extractor_(camera, options.orb),
        starting_extractor_(camera, WithFeatures(options.orb, options.num_features_to_start)),
        scales_(extractor_.scales()),
        context_{camera_, bounds_, scales_, map_},
        late_(context_, options_, &proposer_),
        live_(context_, options_, seed, &proposer_, &late_) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  FrameFeatures Extract(const ImageFrame& image) {
    Stopwatch stopwatch;
    live_.TakeMapOver();
    FrameFeatures features;
    features.frame_seq = image.frame_seq;
    features.stamp_us = image.stamp_us;
    features.published_us = image.published_us;
    features.decode_ms = image.decode_ms;
    OrbExtractor& extractor = live_.LooksForStart() ? starting_extractor_ : extractor_;
    features.features = extractor.Extract(image.pixels);
    features.features_ms = stopwatch.Lap_ms();
    return features;
  }

  TrackerOutput Track(FrameFeatures features) {
    TrackerOutput output;
    live_.TakeMapOver();  // features of a log come without a call to Extract
    live_.Track(MakeFrame(std::move(features)), &output);
    num_proposed_ = output.keyframes.size();
    return output;
  }

  TrackerOutput TrackLate() {
    TrackerOutput output;
    late_.Step(num_proposed_, &output);
    return output;
  }

  TrackerOutput Finish() {
    TrackerOutput output;
    live_.Finish(&output);
    late_.Finish(&output);
    return output;
  }

  bool Apply(const MapDelta& delta) { return map_.Apply(delta); }
  int64_t map_version() const { return map_.version(); }
  void SetUnanswered(int keyframes) { proposer_.SetUnanswered(keyframes); }
  std::vector<Eigen::Vector2f> TrackedPoints() const { return live_.TrackedPoints(); }

 private:
  Frame MakeFrame(FrameFeatures features) const {
    Stopwatch stopwatch;
    CheckOctaves(features.features, scales_, "frontend.orb.num_levels");
    Frame frame;
    frame.seen =
        FrameObservation::Make(features.frame_seq, features.stamp_us, std::move(features.features),
                               bounds_, std::move(features.lines));
    frame.published_us = features.published_us;
    frame.times.decode_ms = features.decode_ms;
    frame.times.features_ms = features.features_ms + stopwatch.Lap_ms();
    return frame;
  }

  const Camera camera_;
  const Camera::Bounds bounds_;
  const TrackerOptions options_;
  OrbExtractor extractor_, starting_extractor_;
  const ScalePyramid scales_;
  MapReplica map_;
  const TrackingContext context_;
  KeyframeProposer proposer_{map_};
  LateWork late_;
  LiveTracker live_;
  size_t num_proposed_ = 0;  ///< by the last call to Track
};

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, uint64_t seed)
    : impl_(std::make_unique<Impl>(camera, options, seed)) {}
Tracker::~Tracker() = default;
FrameFeatures Tracker::Extract(const ImageFrame& image) { return impl_->Extract(image); }
TrackerOutput Tracker::Track(FrameFeatures features) { return impl_->Track(std::move(features)); }
TrackerOutput Tracker::TrackLate() { return impl_->TrackLate(); }
bool Tracker::Apply(const MapDelta& delta) { return impl_->Apply(delta); }
TrackerOutput Tracker::Finish() { return impl_->Finish(); }
void Tracker::SetUnanswered(int keyframes) { impl_->SetUnanswered(keyframes); }
int64_t Tracker::map_version() const { return impl_->map_version(); }
std::vector<Eigen::Vector2f> Tracker::TrackedPoints() const { return impl_->TrackedPoints(); }

}  // namespace vpslam
