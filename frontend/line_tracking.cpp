#include "frontend/line_tracking.h"

#include <algorithm>
#include <set>

#include "core/features/line_matcher.h"
#include "core/map/line_view.h"

namespace vpslam {

int MatchLines(const TrackingContext& context, const std::vector<LineId>& lines, double window_px,
               const LineTrackingOptions& options, Frame* frame) {
  if (!options.enabled || !frame->lines) return 0;
  const std::vector<LineSegment>& segments = frame->lines->lines;
  frame->map_lines.resize(segments.size());
  std::vector<uint8_t> taken(segments.size(), 0);
  std::set<LineId> matched;
  for (size_t i = 0; i < segments.size(); ++i) {
    if (!frame->map_lines[i].IsValid()) continue;
    taken[i] = 1;
    matched.insert(frame->map_lines[i]);
  }
  LineWindow window;
  window.max_offset_px = window_px;
  window.max_distance = options.max_distance;
  window.min_overlap = options.min_overlap;
  int count = 0;
  for (const LineId id : lines) {
    const MapLine* line = context.map.Find(id);
    if (!line || !matched.insert(id).second) continue;
    const auto predicted =
        PredictSegment(*line, frame->cam_from_world, context.camera, context.bounds);
    if (!predicted) continue;
    const auto match = BestLineInWindow(*predicted, line->descriptor, window, segments, taken);
    if (!match) continue;
    taken[match->index] = 1;
    frame->map_lines[match->index] = id;
    ++count;
  }
  return count;
}

std::vector<LineId> LivingLines(const Map& map, const std::vector<LineId>& lines) {
  std::set<LineId> living;
  for (const LineId id : lines) living.insert(map.Resolve(id));
  living.erase(LineId());
  return {living.begin(), living.end()};
}

}  // namespace vpslam
