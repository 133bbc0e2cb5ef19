// Tracks images in a replica of the map; see tracker_interface.h.
//
// Knows neither LCM nor time: what it does depends on its inputs and their order alone.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/camera.h"
#include "frontend/tracker_interface.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class Tracker final : public TrackerInterface {
 public:
  Tracker(const Camera& camera, const TrackerOptions& options, uint64_t seed);
  ~Tracker() override;

  FrameFeatures Extract(const ImageFrame& image) override;
  TrackerOutput Track(FrameFeatures features) override;
  TrackerOutput TrackLate() override;
  bool Apply(const MapDelta& delta) override;
  TrackerOutput Finish() override;
  int64_t map_version() const override;
  std::vector<Eigen::Vector2f> TrackedPoints() const override;
  void SetUnanswered(int keyframes) override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
