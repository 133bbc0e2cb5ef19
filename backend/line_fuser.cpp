#include "backend/line_fuser.h"

#include <algorithm>
#include <set>
#include <vector>

#include "backend/landmark_join.h"
#include "backend/line_view.h"
#include "core/features/line_matcher.h"
#include "core/map/line_view.h"

namespace vpslam {
namespace {

class Fuser {
 public:
  Fuser(const Camera& camera, const Camera::Bounds& bounds, const KeyframeStore& store,
        const LineMappingOptions& options, Map* map)
      : camera_(camera), bounds_(bounds), store_(store), map_(map) {
    window_.max_offset_px = options.max_offset_px;
    window_.min_overlap = options.min_overlap;
    window_.max_distance = options.max_distance;
  }

  void FuseInto(KeyframeId keyframe_id, const std::set<LineId>& lines) {
    const std::vector<LineSegment>& segments = store_.at(keyframe_id).lines.lines;
    for (const LineId id : lines) {
      const MapLine* line = map_->Find(id);
      if (!line || IsObservedBy(*line, keyframe_id)) continue;
      const Keyframe& keyframe = *map_->Find(keyframe_id);
      const auto predicted = PredictSegment(*line, keyframe.cam_from_world, camera_, bounds_);
      if (!predicted) continue;
      const auto match = BestLineInWindow(*predicted, line->descriptor, window_, segments, {});
      if (!match || !Fits(*line, keyframe.cam_from_world, segments[match->index], camera_)) {
        continue;
      }
      changed_.insert(ObserveOrFuse(keyframe_id, keyframe.lines, match->index, id, map_));
    }
  }

  const std::set<LineId>& changed() const { return changed_; }

 private:
  const Camera& camera_;
  const Camera::Bounds& bounds_;
  const KeyframeStore& store_;
  Map* map_;
  LineWindow window_;
  std::set<LineId> changed_;
};

std::set<LineId> LinesOf(const Keyframe& keyframe) {
  std::set<LineId> result(keyframe.lines.begin(), keyframe.lines.end());
  result.erase(LineId());
  return result;
}

}  // namespace

void FuseLines(KeyframeId id, const Camera& camera, const Camera::Bounds& bounds,
               const KeyframeStore& store, const LineMappingOptions& options, Map* map) {
  Fuser fuser(camera, bounds, store, options, map);
  auto neighbours = map->Covisible(id, 1);
  if (static_cast<int>(neighbours.size()) > options.neighbours) {
    neighbours.resize(options.neighbours);
  }
  std::set<LineId> candidates;
  for (const auto& [other, shared] : neighbours) {
    fuser.FuseInto(other, LinesOf(*map->Find(id)));
    candidates.merge(LinesOf(*map->Find(other)));
  }
  fuser.FuseInto(id, candidates);
  for (const LineId line : fuser.changed()) {
    UpdateEnds(line, camera, store, map);
    UpdateDescriptor(line, store, map);
  }
}

}  // namespace vpslam
