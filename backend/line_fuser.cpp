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
  Fuser(const MappingContext& context, const LineMappingOptions& options)
      : camera_(context.camera), bounds_(context.bounds), map_(&context.map) {
    window_.max_offset_px = options.max_offset_px;
    window_.min_overlap = options.min_overlap;
    window_.max_distance = options.max_distance;
  }

  void FuseInto(KeyframeId keyframe_id, const std::set<LineId>& lines) {
    const std::vector<LineSegment>& segments = map_->Find(keyframe_id)->seen->segments();
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
  OwnedMap* map_;
  LineWindow window_;
  std::set<LineId> changed_;
};

std::set<LineId> LinesOf(const Keyframe& keyframe) {
  std::set<LineId> result(keyframe.lines.begin(), keyframe.lines.end());
  result.erase(LineId());
  return result;
}

}  // namespace

void FuseLines(const MappingContext& context, KeyframeId id, const LineMappingOptions& options) {
  OwnedMap* map = &context.map;
  Fuser fuser(context, options);
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
    UpdateEnds(line, context.camera, map);
    UpdateDescriptor(line, map);
  }
}

}  // namespace vpslam
