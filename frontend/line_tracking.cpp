#include "frontend/line_tracking.h"

#include <algorithm>
#include <set>

#include "core/features/line_matcher.h"
#include "core/map/line_view.h"

namespace vpslam {

int MatchLines(const TrackingContext& context, const std::vector<LineId>& lines, double window_px,
               const LineTrackingOptions& options, Frame* frame) {
  if (!options.enabled) return 0;
  const std::vector<LineSegment>& segments = frame->seen->segments();
  const std::vector<LineId>& lines_of_frame = frame->placement.lines();
  std::vector<uint8_t> taken(segments.size(), 0);
  std::set<LineId> matched;
  for (size_t i = 0; i < lines_of_frame.size(); ++i) {
    if (!lines_of_frame[i].IsValid()) continue;
    taken[i] = 1;
    matched.insert(lines_of_frame[i]);
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
        PredictSegment(*line, frame->placement.cam_from_world, context.camera, context.bounds);
    if (!predicted) continue;
    const auto match = BestLineInWindow(*predicted, line->descriptor, window, segments, taken);
    if (!match || !frame->placement.Match(match->index, *line)) continue;
    taken[match->index] = 1;
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
