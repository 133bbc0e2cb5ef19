#include "backend/mapper.h"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

#include "backend/culling.h"
#include "backend/keyframe_insertion.h"
#include "backend/line_creator.h"
#include "backend/line_fuser.h"
#include "backend/line_view.h"
#include "backend/local_ba.h"
#include "backend/manhattan_frames.h"
#include "backend/map_joiner.h"
#include "backend/map_starter.h"
#include "backend/point_creator.h"
#include "backend/point_fuser.h"
#include "backend/point_view.h"
#include "core/base/stopwatch.h"
#include "core/features/octave_check.h"
#include "core/map/owned_map.h"

namespace vpslam {
namespace {

/// More than there are keyframes in what a frontend may still work with: the frames from before a
/// loss, and those that are waiting to be placed.
constexpr int kKeyframesToRemember = 200;

}  // namespace

class Mapper::Impl {
 public:
  Impl(const Camera& camera, const MapperOptions& options)
      : camera_(camera),
        bounds_(camera.UndistortedBounds()),
        options_(options),
        scales_(options.orb.num_levels, options.orb.scale_factor, options.orb.sigma_px),
        context_{camera_, bounds_, scales_, map_},
        live_(options),
        late_(options) {}

  std::vector<MapDelta> Process(const KeyframeProposal& proposal, const IsUrgent& is_urgent) {
    Stopwatch total;
    MappingTimes times;
    CheckOctaves(proposal.features, scales_, "backend.orb.num_levels");
    if (proposal.discarded_map.IsValid()) Discard(proposal.discarded_map);
    switch (proposal.role) {
      case KeyframeRole::kMapFirst:
        first_ = proposal;
        break;
      case KeyframeRole::kMapSecond:
        if (first_) Start(proposal);
        first_.reset();
        break;
      case KeyframeRole::kRegular:
        WorkIn(InPresentMap(proposal), is_urgent, &times);
        break;
    }
    map_.Compact(VersionToForgetBefore(proposal));
    times.total_ms = total.Lap_ms();
    std::vector<MapDelta> deltas = map_.TakeDeltas(proposal.id, times);
    versions_.push_back(map_.version());
    return deltas;
  }

  const OwnedMap& map() const { return map_; }

 private:
  /// Of the landmarks from keyframes that come one after the other: those of the camera as it goes,
  /// and those that are late. What the ones create is not out of sight because the others, which
  /// are elsewhere, do not show it.
  struct Probation {
    explicit Probation(const MapperOptions& options)
        : points(options.culling), lines(options.lines) {}
    PointProbation points;
    LineProbation lines;
    int keyframes = 0;
  };

  /// What was fused before that version is not referred to any more: by then the frontend that
  /// proposes knew of it, and what its frames from before saw has been left behind.
  int64_t VersionToForgetBefore(const KeyframeProposal& proposal) {
    while (std::ssize(versions_) > kKeyframesToRemember) versions_.pop_front();
    if (std::ssize(versions_) < kKeyframesToRemember) return 0;
    return std::min(versions_.front(), proposal.map_version);
  }

  /// Counts the keyframe.
  Probation& ProbationOf(const KeyframeProposal& proposal) {
    const bool is_late = proposal.frame_seq < newest_seq_;
    newest_seq_ = std::max(newest_seq_, proposal.frame_seq);
    Probation& probation = is_late ? late_ : live_;
    ++probation.keyframes;
    return probation;
  }

  /// Vanishing points are of use also where lines are not mapped.
  void TakeAxes(KeyframeProposal* proposal) {
    if (options_.manhattan.enabled) {
      Manhattan(proposal->map).Add(proposal->id, proposal->lines);
    }
    if (!options_.lines.enabled) proposal->lines = LineSet();
  }

  void Discard(MapId id) {
    map_.EraseMap(id);
    manhattan_.erase(id);
  }

  void Start(KeyframeProposal second) {
    TakeAxes(&*first_);
    TakeAxes(&second);
    live_.keyframes += 2;
    newest_seq_ = std::max(newest_seq_, second.frame_seq);
    for (const PointId id : StartMap(context_, *first_, second, options_.ba)) {
      live_.points.Add(id, live_.keyframes);
    }
    AddLines(second.id, &live_);
  }

  void AddLines(KeyframeId keyframe, Probation* probation) {
    for (const LineId id : CreateLines(context_, keyframe, options_.lines)) {
      probation->lines.Add(id, probation->keyframes);
    }
  }

  ManhattanFrames& Manhattan(MapId map) {
    return manhattan_.try_emplace(map, options_.manhattan).first->second;
  }

  /// A frontend that has not heard of a merger yet speaks in coordinates of a map that is no more.
  KeyframeProposal InPresentMap(const KeyframeProposal& proposal) const {
    KeyframeProposal present = proposal;
    for (auto at = mergers_.find(present.map); at != mergers_.end();
         at = mergers_.find(present.map)) {
      present.map = at->second.into;
      present.cam_from_world = TransformWorld(present.cam_from_world, at->second.into_from);
    }
    return present;
  }

  void WorkIn(KeyframeProposal proposal, const IsUrgent& is_urgent, MappingTimes* times) {
    Stopwatch stopwatch;
    ManhattanFrames& manhattan = Manhattan(proposal.map);
    TakeAxes(&proposal);
    Insert(proposal);
    times->insertion_ms = stopwatch.Lap_ms();

    for (const PointSighting& sighting : proposal.sightings) {
      const PointSighting present{map_.Resolve(sighting.point), sighting.visible, sighting.found};
      for (Probation* each : {&live_, &late_}) each->points.Count(present);
    }
    Probation& probation = ProbationOf(proposal);
    probation.points.Cull(probation.keyframes, &map_);
    probation.lines.Cull(probation.keyframes, &map_);
    times->feature_culling_ms = stopwatch.Lap_ms();

    for (const PointId id : CreatePoints(context_, proposal.id, options_.creator)) {
      probation.points.Add(id, probation.keyframes);
    }
    FusePoints(context_, proposal.id, options_.fuser);
    AddLines(proposal.id, &probation);
    FuseLines(context_, proposal.id, options_.lines);
    SetBestParent(proposal.id);
    times->feature_creation_ms = stopwatch.Lap_ms();

    AdjustLocally(context_, proposal.id, manhattan, options_.ba, options_.ba.max_iterations,
                  is_urgent);
    manhattan.Update(proposal.map, &map_);
    times->local_ba_ms = stopwatch.Lap_ms();

    CullKeyframes(proposal.id, options_.culling, &map_);
    times->keyframe_culling_ms = stopwatch.Lap_ms();
    if (proposal.seam.map.IsValid()) Join(proposal);
  }

  void Join(const KeyframeProposal& proposal) {
    const KeyframeId id = proposal.id;
    const auto alignment = AlignSeam(context_, id, proposal.seam, options_.merging);
    if (!alignment) return;
    Merger merger =
        MergerOf(map_.Find(id)->map, map_.Resolve(proposal.seam.map), alignment->there_from_here);
    ManhattanFrames& manhattan = Manhattan(merger.into);
    const auto turn = manhattan.TurnOf(Manhattan(merger.from), merger.into_from.rotation, map_);
    if (turn && manhattan.Contradicts(*turn)) return;  // it looks like the place, but is another
    const MapContents younger = ContentsOf(merger.from, map_);
    JoinMaps(merger, alignment->points, &map_);
    std::vector<KeyframeId> around{id};
    for (const auto& [other, shared] : map_.Covisible(id, options_.ba.min_shared_points)) {
      if (static_cast<int>(around.size()) > options_.merging.neighbours_to_fuse) break;
      around.push_back(other);
    }
    for (const KeyframeId keyframe : around) {
      FusePoints(context_, keyframe, options_.fuser);
    }
    if (turn) {
      // What lies at the seam may be bent, one of the maps ends there; the axes are not. Adjustment
      // across the seam then straightens it between two ends that fit.
      const Eigen::Vector3d seam = map_.Find(id)->cam_from_world.Center();
      const SE3 straightened(*turn, seam - *turn * seam);
      Transform(younger, straightened, &map_);
      merger.into_from = Sim3{straightened.rotation, straightened.translation} * merger.into_from;
    }
    mergers_[merger.from] = merger;
    manhattan.Absorb(Manhattan(merger.from), merger.into_from.rotation, &map_);
    manhattan_.erase(merger.from);
    manhattan.Update(merger.into, &map_);
    LocalBaOptions ba = options_.ba;
    ba.max_keyframes = ba.max_fixed_keyframes = options_.merging.max_keyframes;
    AdjustLocally(context_, id, manhattan, ba, options_.merging.max_iterations);
    SetBestParent(id);
  }

  void Insert(const KeyframeProposal& proposal) {
    Keyframe keyframe = ToKeyframe(proposal, map_.LivingAncestor(proposal.reference), bounds_);
    for (size_t i = 0; i < proposal.points.size(); ++i) {
      keyframe.points[i] = map_.Resolve(proposal.points[i]);
    }
    if (options_.lines.enabled) {
      for (const LineId id : proposal.map_lines) keyframe.lines.push_back(map_.Resolve(id));
    }
    map_.Insert(keyframe);
    SetAxesOf(*map_.Find(keyframe.id));
    for (const PointId id : map_.Find(keyframe.id)->points) {
      if (!id.IsValid()) continue;
      UpdateView(id, scales_, &map_);
      UpdateDescriptor(id, &map_);
    }
    for (const LineId id : map_.Find(keyframe.id)->lines) {
      if (id.IsValid()) UpdateDescriptor(id, &map_);
    }
  }

  /// Of the frame whose axes it sees, or else of the one where it is.
  void SetAxesOf(const Keyframe& keyframe) {
    ManhattanId seen = Manhattan(keyframe.map).Expect(keyframe);
    const Keyframe* parent = map_.Find(keyframe.parent);
    if (!seen.IsValid() && parent) seen = parent->manhattan;
    map_.SetManhattanOf(keyframe.id, seen);
  }

  /// The parent is the older keyframe that shares most: poses of what is culled hang on it.
  void SetBestParent(KeyframeId id) {
    for (const auto& [other, shared] : map_.Covisible(id, 1)) {
      if (other < id) {
        map_.SetParent(id, other);
        return;
      }
    }
  }

  Camera camera_;
  Camera::Bounds bounds_;
  MapperOptions options_;
  ScalePyramid scales_;
  OwnedMap map_;
  MappingContext context_;
  std::map<MapId, ManhattanFrames> manhattan_;
  Probation live_, late_;
  int64_t newest_seq_ = -1;
  std::deque<int64_t> versions_;     ///< of the map, after each of the latest keyframes
  std::map<MapId, Merger> mergers_;  ///< by what was merged
  std::optional<KeyframeProposal> first_;
};

std::optional<std::string> MapperOptions::Validate() const {
  if (const auto why = orb.Validate()) return why;
  if (ba.max_keyframes < 2 || ba.max_iterations < 1) return "ba: needs 2 keyframes, 1 iteration";
  if (creator.neighbours < 1 || fuser.neighbours < 1) return "neighbours must be at least 1";
  if (manhattan.keyframes_to_birth < 1 || manhattan.loss_window < 1) {
    return "manhattan: keyframes_to_birth and loss_window must be at least 1";
  }
  if (!(manhattan.min_sigma_deg > 0) || !(manhattan.max_sigma_deg > 0)) {
    return "manhattan: min_sigma_deg and max_sigma_deg must be above 0";
  }
  if (!(manhattan.max_innovation_deg > 0 && manhattan.max_correction_deg < 45)) {
    return "manhattan: innovation and correction must lie in 0 to 45 deg, where axes change names";
  }
  if (manhattan.max_correction_deg < manhattan.max_innovation_deg) {
    return "manhattan: max_correction_deg must not be less than max_innovation_deg";
  }
  return std::nullopt;
}

Mapper::Mapper(const Camera& camera, const MapperOptions& options)
    : impl_(std::make_unique<Impl>(camera, options)) {}
Mapper::~Mapper() = default;
std::vector<MapDelta> Mapper::Process(const KeyframeProposal& proposal, const IsUrgent& is_urgent) {
  return impl_->Process(proposal, is_urgent);
}
std::vector<MapDelta> Mapper::Snapshot() const { return impl_->map().Snapshot(); }
int64_t Mapper::version() const { return impl_->map().version(); }

}  // namespace vpslam
