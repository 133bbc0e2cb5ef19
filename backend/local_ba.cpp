#include "backend/local_ba.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include "backend/ba_window.h"
#include "backend/line_view.h"
#include "backend/point_view.h"
#include "core/estimation/line_cost.h"
#include "core/estimation/line_residual.h"
#include "core/estimation/point_cost.h"
#include "core/estimation/point_residual.h"
#include "core/estimation/robust.h"
#include "core/estimation/rotation_cost.h"
#include "core/estimation/se3_manifold.h"
#include "core/features/corner_accuracy.h"
#include "core/map/depth_quantile.h"

namespace vpslam {
namespace {

/// Leaves it at what has been reached when others wait.
class StopWhenUrgent : public ceres::IterationCallback {
 public:
  StopWhenUrgent(const IsUrgent& is_urgent, int min_iterations)
      : is_urgent_(is_urgent), min_iterations_(min_iterations) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    return iteration.iteration >= min_iterations_ && is_urgent_()
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const IsUrgent& is_urgent_;
  int min_iterations_;
};

class Adjustment {
 public:
  /// `robust`: outliers may be among the observations.
  Adjustment(const BaWindow& window, const MappingContext& context,
             const ManhattanFrames& manhattan, const LocalBaOptions& options, bool robust)
      : window_(window),
        options_(options),
        camera_(context.camera),
        scales_(context.scales),
        map_(context.map),
        observation_loss_(robust ? &loss_ : nullptr),
        problem_(ProblemOptions()),
        ordering_(std::make_shared<ceres::ParameterBlockOrdering>()) {
    std::set<KeyframeId> keyframes = window.moved;
    keyframes.insert(window.fixed.begin(), window.fixed.end());
    pose_storage_.reserve(keyframes.size());
    for (const KeyframeId id : keyframes) {
      pose_storage_.push_back(ToParameters(map_.Find(id)->cam_from_world));
      poses_[id] = pose_storage_.back().data();
    }
    landmark_storage_.reserve(3 * window.points.size() + 6 * window.lines.size());
    positions_.reserve(window.points.size());
    for (const PointId id : window.points) {
      if (const MapPoint* point = map_.Find(id)) AddPoint(*point);
    }
    lines_.reserve(window.lines.size());
    for (const LineId id : window.lines) {
      if (const MapLine* line = map_.Find(id)) AddLine(*line);
    }
    for (const KeyframeId id : window.moved) AddRotation(*map_.Find(id), manhattan);
  }

  BaSummary Solve(int max_iterations, const IsUrgent& is_urgent) {
    for (const auto& [id, pose] : poses_) {
      if (!problem_.HasParameterBlock(pose)) continue;
      problem_.SetManifold(pose, &manifold_);
      ordering_->AddElementToGroup(pose, 1);
      if (window_.fixed.contains(id)) problem_.SetParameterBlockConstant(pose);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    // Eigen, not the BLAS that the host happens to have: results must not depend on it.
    options.dense_linear_algebra_library_type = ceres::EIGEN;
    options.linear_solver_ordering = ordering_;
    options.num_threads = 1;
    options.max_num_iterations = max_iterations;
    options.function_tolerance = options_.function_tolerance;
    StopWhenUrgent stop(is_urgent, options_.min_iterations_when_urgent);
    if (is_urgent) options.callbacks.push_back(&stop);
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    BaSummary result;
    if (problem_.NumResidualBlocks() > 0) {
      ceres::Solve(options, &problem_, &summary);
      result.usable = summary.IsSolutionUsable();
    }
    result.keyframes = static_cast<int>(window_.moved.size());
    result.fixed_keyframes = static_cast<int>(window_.fixed.size());
    result.points = static_cast<int>(window_.points.size());
    result.observations = static_cast<int>(costs_.size());
    result.iterations = static_cast<int>(summary.iterations.size());
    result.initial_cost = summary.initial_cost;
    result.final_cost = summary.final_cost;
    return result;
  }

  void WriteBack(OwnedMap* map) const {
    for (const KeyframeId id : window_.moved) {
      map->SetPose(id, FromParameters(poses_.at(id)));
    }
    for (const auto& [id, position] : positions_) {
      map->SetPosition(id, Eigen::Map<const Eigen::Vector3d>(position));
    }
    for (const auto& [id, line] : lines_) {
      const Eigen::Map<const Eigen::Vector3d> point(line), direction(line + 3);
      const double half_length = 0.5 * (map->Find(id)->end - map->Find(id)->start).norm();
      map->SetEnds(id, point - half_length * direction, point + half_length * direction);
    }
  }

 private:
  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  /// Room is reserved, so that nothing moves.
  double* Allocate(const double* values, size_t size) {
    landmark_storage_.insert(landmark_storage_.end(), values, values + size);
    return landmark_storage_.data() + landmark_storage_.size() - size;
  }

  void AddPoint(const MapPoint& point) {
    double* position = Allocate(point.position.data(), 3);
    bool used = false;
    for (const Observation& o : point.observations) {
      const auto pose = poses_.find(o.keyframe);
      if (pose == poses_.end()) continue;
      const Keypoint& keypoint = map_.Find(o.keyframe)->seen->features.keypoints[o.feature];
      costs_.emplace_back(camera_, keypoint.Position(), CornerSqrtInformation(keypoint, scales_));
      problem_.AddResidualBlock(&costs_.back(), observation_loss_, pose->second, position);
      used = true;
    }
    if (!used) return;
    ordering_->AddElementToGroup(position, 0);
    positions_.emplace_back(point.id, position);
  }

  /// Two views and no direction leave a line free to be anything: it stays out.
  void AddLine(const MapLine& line) {
    const bool is_held = line.axis >= 0;
    if (line.observations.size() < 3 && !is_held) return;
    const LineParameters initial = ToLineParameters(line.start, line.end);
    double* parameters = Allocate(initial.data(), initial.size());
    bool used = false;
    for (const Observation& o : line.observations) {
      const auto pose = poses_.find(o.keyframe);
      if (pose == poses_.end()) continue;
      const LineSegment& segment = map_.Find(o.keyframe)->seen->segments()[o.feature];
      line_costs_.emplace_back(camera_, segment.start_px.cast<double>(),
                               segment.end_px.cast<double>(), 1 / LineSigma_px(segment.sigma_px));
      problem_.AddResidualBlock(&line_costs_.back(), observation_loss_, pose->second, parameters);
      used = true;
    }
    if (!used) return;
    lines_.emplace_back(line.id, parameters);
    if (is_held) {
      direction_costs_.emplace_back(AxisDirection(line.axis, line.manhattan, map_),
                                    options_.direction_sigma_deg * std::numbers::pi / 180);
      problem_.AddResidualBlock(&direction_costs_.back(), &loss_, parameters);
      held_lines_.insert(line.id);
    }
    problem_.SetManifold(parameters, &line_manifold_);
    ordering_->AddElementToGroup(parameters, 0);
  }

  /// Segments of lines that are held to their axis already tell the rotation by that: they don't
  /// count again.
  void AddRotation(const Keyframe& keyframe, const ManhattanFrames& manhattan) {
    const std::vector<LineSegment>& segments = keyframe.seen->segments();
    const std::optional<ManhattanBinding> binding = manhattan.Find(keyframe.id);
    double* pose = poses_.at(keyframe.id);
    if (!binding || !problem_.HasParameterBlock(pose)) return;
    int labelled = 0, counted = 0;
    for (size_t i = 0; i < segments.size(); ++i) {
      if (segments[i].label < 0 || segments[i].label > 2) continue;
      ++labelled;
      counted += i < keyframe.lines.size() && held_lines_.contains(keyframe.lines[i]);
    }
    if (counted == labelled && labelled > 0) return;
    const double share = labelled > 0 ? 1.0 - static_cast<double>(counted) / labelled : 1.0;
    const ManhattanMeasurement& measured = binding->measurement;
    const Eigen::LLT<Eigen::Matrix3d> information(share * measured.covariance_rad2.inverse());
    rotation_costs_.emplace_back(measured.cam_from_manhattan, binding->world_from_manhattan,
                                 information.matrixU());
    problem_.AddResidualBlock(&rotation_costs_.back(), &rotation_loss_, pose);
  }

  const BaWindow& window_;
  const LocalBaOptions& options_;
  const Camera& camera_;
  const ScalePyramid& scales_;
  const Map& map_;
  Se3Manifold manifold_;
  ceres::HuberLoss loss_{std::sqrt(kChi2Dof2)};
  ceres::LossFunction* observation_loss_;  ///< nullptr: squares
  ceres::HuberLoss rotation_loss_{std::sqrt(kChi2Dof3)};
  std::deque<PointCost> costs_;
  std::deque<RotationCost> rotation_costs_;
  std::deque<LineCost> line_costs_;
  std::deque<LineDirectionCost> direction_costs_;
  ceres::LineManifold<3> line_manifold_;
  // Ceres orders the blocks of a group by their addresses, and rounding depends on that order. So
  // the blocks lie one after the other by id, wherever the heap happens to have room.
  std::vector<PoseParameters> pose_storage_;
  std::map<KeyframeId, double*> poses_;
  std::vector<double> landmark_storage_;
  std::vector<std::pair<PointId, double*>> positions_;
  std::vector<std::pair<LineId, double*>> lines_;
  std::set<LineId> held_lines_;  ///< to their axes
  ceres::Problem problem_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_;
};

/// Takes observations of the window away that do not fit; `fits` takes landmark and observation.
template <class Id, class DoesFit>
int RemoveOutliers(const BaWindow& window, const std::set<Id>& ids, const DoesFit& fits,
                   OwnedMap* map) {
  std::vector<std::pair<KeyframeId, Id>> outliers;
  for (const Id id : ids) {
    const auto& landmark = *map->Find(id);
    for (const Observation& o : landmark.observations) {
      if (!window.moved.contains(o.keyframe) && !window.fixed.contains(o.keyframe)) continue;
      if (!fits(landmark, o)) outliers.emplace_back(o.keyframe, id);
    }
  }
  for (const auto& [keyframe, id] : outliers) {
    if (map->Find(id)) map->Unobserve(keyframe, id);
  }
  return static_cast<int>(outliers.size());
}

}  // namespace

BaSummary AdjustLocally(const MappingContext& context, KeyframeId keyframe,
                        const ManhattanFrames& manhattan, const LocalBaOptions& options,
                        int max_iterations, const IsUrgent& is_urgent) {
  const auto& [camera, bounds, scales, owned_map] = context;
  OwnedMap* map = &owned_map;
  const BaWindow window = ChooseBaWindow(keyframe, options, *map);
  const auto adjust = [&](bool robust, int iterations) {
    Adjustment adjustment(window, context, manhattan, options, robust);
    const BaSummary summary = adjustment.Solve(iterations, is_urgent);
    if (summary.usable) adjustment.WriteBack(map);
    return summary;
  };
  const auto point_fits = [&](const MapPoint& point, const Observation& o) {
    const Keyframe& seen_from = *map->Find(o.keyframe);
    const Keypoint& keypoint = seen_from.seen->features.keypoints[o.feature];
    const Eigen::Vector3d x = seen_from.cam_from_world * point.position;
    return !(x.z() < kMinDepth || (camera.Project(x) - keypoint.Position()).squaredNorm() >
                                      kChi2Dof2 * scales.sigma2(keypoint.octave));
  };
  std::map<KeyframeId, double> min_depths;
  const auto min_depth = [&](KeyframeId id) {
    const auto [at, is_new] = min_depths.try_emplace(id, 0);
    if (is_new) at->second = options.min_line_depth_share * DepthQuantile(*map, id, 0.05);
    return at->second;
  };
  const auto line_fits = [&](const MapLine& line, const Observation& o) {
    const Keyframe& seen_from = *map->Find(o.keyframe);
    const SE3& cam_from_world = seen_from.cam_from_world;
    return !IsTooNear(line, cam_from_world, min_depth(o.keyframe)) &&
           Fits(line, cam_from_world, seen_from.seen->segments()[o.feature], camera);
  };
  BaSummary summary = adjust(true, max_iterations);
  if (!summary.usable) return summary;
  summary.outliers = RemoveOutliers(window, window.points, point_fits, map) +
                     RemoveOutliers(window, window.lines, line_fits, map);
  const bool is_late = is_urgent && is_urgent();
  if (summary.outliers > 0 && options.max_iterations_after_outliers > 0 && !is_late) {
    adjust(false, options.max_iterations_after_outliers);
  }
  for (const PointId point : window.points) UpdateView(point, scales, map);
  for (const LineId line : window.lines) UpdateEnds(line, camera, map);
  return summary;
}

}  // namespace vpslam
