#include "backend/line_creator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "backend/line_view.h"
#include "core/estimation/point_residual.h"
#include "core/features/line_matcher.h"
#include "core/geometry/sphere.h"
#include "core/map/depth_quantile.h"
#include "core/map/line_view.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kMaxDirectionDifference_rad = 2 * kRadPerDeg;

bool IsFree(const Keyframe& keyframe, int segment) {
  return segment >= static_cast<int>(keyframe.lines.size()) || !keyframe.lines[segment].IsValid();
}

struct View {
  KeyframeId id;
  SE3 cam_from_world;
  const LineSet* lines;
};

class Creator {
 public:
  Creator(const MappingContext& context, const LineMappingOptions& options)
      : camera_(context.camera), bounds_(context.bounds), options_(options), map_(&context.map) {
    triangulation_.min_ray_plane_angle_rad = options.min_ray_plane_angle_deg * kRadPerDeg;
  }

  std::vector<LineId> Run(KeyframeId id) {
    const View first = MakeView(id);
    auto covisible = map_->Covisible(id, 1);
    if (static_cast<int>(covisible.size()) > options_.neighbours) {
      covisible.resize(options_.neighbours);
    }
    for (const auto& [other, shared] : covisible) neighbours_.push_back(MakeView(other));
    is_first_map_ = map_->NumKeyframes(map_->Find(id)->map) == 2;
    max_depth_ = options_.max_depth_ratio * DepthQuantile(*map_, id, 0.9);
    near_depth_ = DepthQuantile(*map_, id, 0.05);
    std::vector<LineId> created;
    for (size_t i = 0; i < first.lines->lines.size(); ++i) {
      const auto segment = static_cast<int32_t>(i);
      if (!first.lines->lines[i].has_descriptor || !IsFree(*map_->Find(id), segment)) continue;
      for (const View& second : neighbours_) {
        const std::optional<LineId> line = TryPair(first, segment, second);
        if (!line) continue;
        created.push_back(*line);
        break;
      }
    }
    return created;
  }

 private:
  struct Candidate {
    int32_t segment = -1;
    int distance = 257;
    std::optional<MapLine> line;  ///< none where it is too far away to be placed, or too near
    bool has_direction = false;   ///< by vanishing points
  };

  View MakeView(KeyframeId id) const {
    const Keyframe& keyframe = *map_->Find(id);
    return {id, keyframe.cam_from_world, keyframe.seen->lines.get()};
  }

  std::optional<LineId> TryPair(const View& first, int32_t segment, const View& second) {
    const LineSegment& a = first.lines->lines[segment];
    const Keyframe& keyframe = *map_->Find(second.id);
    const double min_depth = options_.min_depth_share * near_depth_;
    Candidate best, runner_up;
    for (size_t j = 0; j < second.lines->lines.size(); ++j) {
      const LineSegment& b = second.lines->lines[j];
      if (!b.has_descriptor || !IsFree(keyframe, static_cast<int>(j))) continue;
      const int distance = Distance(a.descriptor, b.descriptor);
      if (distance > options_.max_distance || distance >= runner_up.distance) continue;
      bool has_direction = false;
      std::optional<MapLine> line = Triangulate(first, a, second, b, &has_direction);
      if (!line && !MayBeFar(first, a, second, b)) continue;
      if (line && IsTooNear(*line, first.cam_from_world, min_depth)) line.reset();
      Candidate candidate{static_cast<int32_t>(j), distance, line, has_direction};
      if (candidate.distance < best.distance) std::swap(candidate, best);
      if (candidate.distance < runner_up.distance) runner_up = candidate;
    }
    if (!best.line || best.distance > options_.ratio * runner_up.distance) return std::nullopt;
    best.line->descriptor = a.descriptor;
    return Establish(first, segment, second, best);
  }

  /// Whether the two segments show one line if that is too far away for its depth to be told. Were
  /// these not in the competition, then of a row of bars the next one, displaced by a period, would
  /// win for lack of rivals.
  bool MayBeFar(const View& first, const LineSegment& a, const View& second,
                const LineSegment& b) const {
    const LineView from = ViewSegment(a, first.cam_from_world, camera_);
    const Eigen::Vector3d normal = ViewSegment(b, second.cam_from_world, camera_).Normal();
    const double max_sine = std::sin(triangulation_.min_ray_plane_angle_rad);
    ImageSegment at_infinity;
    for (const auto& [ray, px] : {std::pair(from.start_ray, &at_infinity.start_px),
                                  std::pair(from.end_ray, &at_infinity.end_px)}) {
      const Eigen::Vector3d in_second = second.cam_from_world.rotation * ray;
      if (std::abs(normal.dot(ray)) > max_sine || in_second.z() < kMinDepth) return false;
      *px = camera_.Project(in_second);
    }
    return Overlaps(at_infinity, ToImageSegment(b));
  }

  bool Overlaps(const ImageSegment& predicted, const ImageSegment& seen) const {
    const SegmentRelation relation = Relate(predicted, seen);
    const double shorter_px = std::min(predicted.Length(), seen.Length());
    return relation.cosine >= 0 && relation.overlap_px >= options_.min_overlap * shorter_px;
  }

  /// nullopt where the two segments can't be of one line.
  std::optional<MapLine> Triangulate(const View& first, const LineSegment& a, const View& second,
                                     const LineSegment& b, bool* has_direction) const {
    const std::array views = {ViewSegment(a, first.cam_from_world, camera_),
                              ViewSegment(b, second.cam_from_world, camera_)};
    MapLine line;
    line.axis = CommonAxis(first, a, second, b);
    if (line.axis >= 0) line.manhattan = map_->Find(first.id)->manhattan;
    const std::optional<Eigen::Vector3d> direction =
        line.axis >= 0 ? AxisDirection(line.axis, line.manhattan, *map_)
                       : CommonDirection(first, a, second, b);
    const auto found = direction ? TriangulateLineAlong(*direction, views, triangulation_)
                                 : TriangulateLine(views[0], views[1], triangulation_);
    if (!found) return std::nullopt;
    *has_direction = direction.has_value();
    line.start = found->start;
    line.end = found->end;
    for (const Eigen::Vector3d& end : {line.start, line.end}) {
      const double depth = (first.cam_from_world * end).z();
      if (!(depth > 0) || depth > max_depth_) return std::nullopt;
    }
    if (!Fits(line, first.cam_from_world, a, camera_) ||
        !Fits(line, second.cam_from_world, b, camera_)) {
      return std::nullopt;
    }
    const auto predicted = PredictSegment(line, second.cam_from_world, camera_, bounds_);
    if (!predicted || !Overlaps(*predicted, ToImageSegment(b))) return std::nullopt;
    return line;
  }

  /// Of the vanishing points of both segments, in world, if they are one. In a map of two views
  /// there is no third to ask, and no Manhattan frame yet; later those tell more.
  std::optional<Eigen::Vector3d> CommonDirection(const View& first, const LineSegment& a,
                                                 const View& second, const LineSegment& b) const {
    if (!is_first_map_ || a.label < 0 || b.label < 0) return std::nullopt;
    const auto in_world = [](const View& view, int32_t label) {
      return Eigen::Vector3d(view.cam_from_world.rotation.conjugate() *
                             view.lines->vanishing_points[label].direction_in_cam);
    };
    const Eigen::Vector3d u = in_world(first, a.label), v = in_world(second, b.label);
    if (AxisAngle_rad(u, v) > kMaxDirectionDifference_rad) return std::nullopt;
    return Eigen::Vector3d(u + (u.dot(v) < 0 ? -1.0 : 1.0) * v).normalized();
  }

  int CommonAxis(const View& first, const LineSegment& a, const View& second,
                 const LineSegment& b) const {
    const Keyframe &one = *map_->Find(first.id), &other = *map_->Find(second.id);
    if (one.manhattan != other.manhattan) return -1;
    const int axis = AxisOf(a, *first.lines, one, *map_);
    return axis >= 0 && axis == AxisOf(b, *second.lines, other, *map_) ? axis : -1;
  }

  /// Looks for the line in the other neighbours; creates it where that is evidence enough.
  std::optional<LineId> Establish(const View& first, int32_t segment, const View& second,
                                  const Candidate& candidate) {
    LineWindow window;
    window.max_offset_px = options_.max_offset_px;
    window.min_overlap = options_.min_overlap;
    window.max_distance = options_.max_distance;
    std::vector<std::pair<KeyframeId, int32_t>> others;
    for (const View& view : neighbours_) {
      if (view.id == second.id) continue;
      const auto predicted = PredictSegment(*candidate.line, view.cam_from_world, camera_, bounds_);
      if (!predicted) continue;
      const auto match =
          BestLineInWindow(*predicted, candidate.line->descriptor, window, view.lines->lines, {});
      if (!match || !IsFree(*map_->Find(view.id), match->index)) continue;
      others.emplace_back(view.id, match->index);
    }
    if (others.empty() && !candidate.has_direction) return std::nullopt;
    if (2 + std::ssize(others) < options_.min_views_near &&
        IsTooNear(*candidate.line, first.cam_from_world, near_depth_)) {
      return std::nullopt;
    }
    const LineId id = map_->CreateLine(map_->Find(first.id)->map, first.id, candidate.line->start,
                                       candidate.line->end);
    map_->SetAxis(id, candidate.line->manhattan, candidate.line->axis);
    map_->Observe(first.id, segment, id);
    map_->Observe(second.id, candidate.segment, id);
    for (const auto& [keyframe, index] : others) map_->Observe(keyframe, index, id);
    UpdateEnds(id, camera_, map_);
    UpdateDescriptor(id, map_);
    return id;
  }

  const Camera& camera_;
  const Camera::Bounds& bounds_;
  const LineMappingOptions& options_;
  OwnedMap* map_;
  LineTriangulationOptions triangulation_;
  std::vector<View> neighbours_;
  double near_depth_ = 0;  ///< that 95 % of the points exceed
  double max_depth_ = 0;
  bool is_first_map_ = false;
};

}  // namespace

std::vector<LineId> CreateLines(const MappingContext& context, KeyframeId id,
                                const LineMappingOptions& options) {
  return Creator(context, options).Run(id);
}

}  // namespace vpslam
