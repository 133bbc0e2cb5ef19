#include "frontend/local_map.h"

#include <algorithm>
#include <set>

#include "core/features/matcher.h"
#include "core/map/visibility.h"
#include "core/map/votes.h"

namespace vpslam {
namespace {

/// cos of 3.6 degrees.
constexpr double kFrontalCosine = 0.998;

}  // namespace

LocalMap CollectLocalMap(const Map& map, const Frame& frame, const LocalMapOptions& options) {
  LocalMap local;
  Votes votes(map.keyframes());
  for (const PointId id : frame.placement.points()) {
    const MapPoint* point = map.Find(id);
    if (!point) continue;
    for (const Observation& o : point->observations) votes.Add(o.keyframe);
  }
  for (const LineId id : frame.placement.lines()) {
    const MapLine* line = map.Find(id);
    if (!line) continue;
    for (const Observation& o : line->observations) votes.Add(o.keyframe);
  }
  const std::vector<std::pair<KeyframeId, int>> voted = votes.Ranked();
  Marks chosen(map.keyframes());
  const auto add = [&](KeyframeId id) {
    if (static_cast<int>(local.keyframes.size()) >= options.max_keyframes) return;
    if (chosen.Insert(id)) local.keyframes.push_back(id);
  };
  for (const auto& [id, count] : voted) add(id);
  if (!voted.empty()) {
    local.reference = voted.front().first;
    // Neighbours of the best few: their points come into view next.
    const size_t num_roots = std::min<size_t>(voted.size(), 5);
    for (size_t i = 0; i < num_roots; ++i) {
      const KeyframeId root = voted[i].first;
      const auto covisible = map.Covisible(root, 15);
      const size_t n = std::min<size_t>(covisible.size(), options.neighbours);
      for (size_t k = 0; k < n; ++k) add(covisible[k].first);
      add(map.Find(root)->parent);
    }
  }
  Marks seen(map.points());
  for (const KeyframeId id : local.keyframes) {
    for (const PointId point : map.Find(id)->points) {
      if (seen.Insert(point)) local.points.push_back(point);
    }
  }
  std::sort(local.points.begin(), local.points.end());
  std::set<LineId> lines;
  for (const KeyframeId id : local.keyframes) {
    const std::vector<LineId>& observed = map.Find(id)->lines;
    lines.insert(observed.begin(), observed.end());
  }
  lines.erase(LineId());
  local.lines.assign(lines.begin(), lines.end());
  return local;
}

int MatchLocalMap(const TrackingContext& context, const LocalMap& local,
                  const LocalMapOptions& options, double radius_factor, Frame* frame,
                  std::vector<PointId>* visible) {
  const FrameObservation& seen = *frame->seen;
  const std::vector<PointId>& points = frame->placement.points();
  std::vector<uint8_t> taken(seen.num_features(), 0);
  Marks matched(context.map.points());
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].IsValid()) continue;
    taken[i] = 1;
    matched.Insert(points[i]);
    visible->push_back(points[i]);
  }
  const SE3& cam_from_world = frame->placement.cam_from_world;
  const Eigen::Vector3d center = cam_from_world.Center();
  int count = 0;
  for (const PointId id : local.points) {
    const MapPoint* point = context.map.Find(id);
    if (!point || matched.Contains(id)) continue;
    const auto view =
        PredictView(*point, cam_from_world, center, context.camera, context.bounds, context.scales);
    if (!view) continue;
    visible->push_back(id);
    const double radius_px =
        view->view_cosine > kFrontalCosine ? options.radius_frontal_px : options.radius_px;
    WindowQuery query;
    query.x_px = static_cast<float>(view->px.x());
    query.y_px = static_cast<float>(view->px.y());
    query.radius_px =
        static_cast<float>(radius_factor * radius_px * context.scales.scale(view->octave));
    query.octaves = {std::max(0, view->octave - 1), view->octave + 1};
    query.max_distance = options.max_distance;
    query.ratio = static_cast<float>(options.ratio);
    const auto match = BestMatchInWindow(point->descriptor, query, seen.features, seen.grid, taken);
    if (!match || !frame->placement.Match(match->index, *point)) continue;
    taken[match->index] = 1;
    ++count;
  }
  return count;
}

}  // namespace vpslam
