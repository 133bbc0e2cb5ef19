#include "backend/manhattan_frames.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "core/features/manhattan_quality.h"
#include "core/geometry/axis_naming.h"
#include "core/geometry/so3.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
/// Half of the chi-square distribution with three degrees of freedom lies below it.
constexpr double kMedianChi2Dof3 = 2.366;

Eigen::Quaterniond WorldFromManhattan(const ManhattanMeasurement& m, const Keyframe& keyframe) {
  return (keyframe.cam_from_world.rotation.conjugate() * m.cam_from_manhattan).normalized();
}

void Rename(const Eigen::Quaterniond& predicted, ManhattanMeasurement* m) {
  m->cam_from_manhattan = NamedNearest(m->cam_from_manhattan, predicted).normalized();
}

/// Weighted mean of rotations that lie within a few degrees of `start`.
class MeanRotation {
 public:
  explicit MeanRotation(const Eigen::Quaterniond& start) : start_(start) {}
  void Add(const Eigen::Quaterniond& rotation, double weight) {
    sum_ += weight * LogSo3(rotation * start_.conjugate());
    weight_ += weight;
  }
  Eigen::Quaterniond Get() const {
    return weight_ > 0 ? (ExpSo3(sum_ / weight_) * start_).normalized() : start_;
  }

 private:
  Eigen::Quaterniond start_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  double weight_ = 0;
};

/// The largest group of turns that lie within `max_spread_rad` of one of them: how many, and their
/// mean.
std::pair<int, Eigen::Vector3d> LargestGroup(const std::vector<Eigen::Vector3d>& turns,
                                             double max_spread_rad) {
  std::pair<int, Eigen::Vector3d> largest{0, Eigen::Vector3d::Zero()};
  for (const Eigen::Vector3d& candidate : turns) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int agreeing = 0;
    for (const Eigen::Vector3d& turn : turns) {
      if ((turn - candidate).norm() > max_spread_rad) continue;
      sum += turn;
      ++agreeing;
    }
    if (agreeing > largest.first) largest = {agreeing, sum / agreeing};
  }
  return largest;
}

}  // namespace

void ManhattanFrames::Add(KeyframeId keyframe, const LineSet& lines) {
  if (!IsSoundManhattan(lines, options_.min_support, options_.max_sigma_deg * kRadPerDeg)) return;
  entries_[keyframe] = {{lines.cam_from_manhattan, lines.covariance_rad2}};
}

std::vector<Eigen::Quaterniond> ManhattanFrames::worlds_from_manhattan() const {
  std::vector<Eigen::Quaterniond> worlds;
  for (const Frame& frame : frames_) worlds.push_back(frame.world_from_manhattan);
  return worlds;
}

// ---- Merging ----

std::optional<Eigen::Quaterniond> ManhattanFrames::TurnOf(
    const ManhattanFrames& other, const Eigen::Quaterniond& world_from_other_world,
    const Map& map) const {
  int most = 0;
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  std::ptrdiff_t asked = 0;
  for (const Frame& frame : frames_) {
    std::vector<Eigen::Vector3d> turns;
    for (const auto& [id, entry] : other.entries_) {
      const Keyframe* keyframe = map.Find(id);
      if (!keyframe) continue;
      const Eigen::Quaterniond theirs =
          NamedNearest(world_from_other_world * WorldFromManhattan(entry.measurement, *keyframe),
                       frame.world_from_manhattan);
      turns.push_back(LogSo3(frame.world_from_manhattan * theirs.conjugate()));
    }
    asked = std::ssize(turns);
    const auto [agreeing, mean] = LargestGroup(turns, options_.max_birth_spread_deg * kRadPerDeg);
    if (agreeing > most) {
      most = agreeing;
      best = mean;
    }
  }
  if (most < options_.keyframes_to_birth || 2 * most < asked) return std::nullopt;
  return ExpSo3(best);
}

bool ManhattanFrames::Contradicts(const Eigen::Quaterniond& turn) const {
  return LogSo3(turn).norm() > options_.max_correction_deg * kRadPerDeg;
}

void ManhattanFrames::Absorb(const ManhattanFrames& other,
                             const Eigen::Quaterniond& world_from_other_world, OwnedMap* map) {
  entries_.insert(other.entries_.begin(), other.entries_.end());
  const std::vector<Frame> mine = frames_;
  for (Frame theirs : other.frames_) {
    theirs.world_from_manhattan =
        (world_from_other_world * theirs.world_from_manhattan).normalized();
    const bool known = std::any_of(mine.begin(), mine.end(), [&](const Frame& frame) {
      const Eigen::Quaterniond named =
          NamedNearest(theirs.world_from_manhattan, frame.world_from_manhattan);
      return AngleBetween_rad(named, frame.world_from_manhattan) <=
             options_.max_correction_deg * kRadPerDeg;
    });
    if (!known) {
      frames_.push_back(theirs);
    } else if (theirs.id.IsValid()) {
      map->EraseManhattan(theirs.id);
    }
  }
}

// ---- What binds a keyframe ----

std::optional<ManhattanBinding> ManhattanFrames::Find(KeyframeId keyframe) const {
  const auto at = entries_.find(keyframe);
  if (at == entries_.end() || !at->second.binds) return std::nullopt;
  return ManhattanBinding{WithExtra(at->second),
                          frames_[static_cast<size_t>(at->second.frame)].world_from_manhattan};
}

void ManhattanFrames::Judge(const Keyframe& keyframe, Entry* entry) const {
  const ManhattanMeasurement reported = entry->measurement;
  entry->frame = -1;
  entry->fits = entry->binds = false;
  for (size_t i = 0; i < frames_.size(); ++i) {
    const Eigen::Quaterniond& frame = frames_[i].world_from_manhattan;
    ManhattanMeasurement named = reported;
    Rename(keyframe.cam_from_world.rotation * frame, &named);
    const double innovation_rad = AngleBetween_rad(WorldFromManhattan(named, keyframe), frame);
    if (entry->frame >= 0 && innovation_rad >= entry->innovation_rad) continue;
    entry->frame = static_cast<int>(i);
    entry->measurement = named;
    entry->innovation_rad = innovation_rad;
  }
  if (entry->frame < 0) return;
  entry->fits = entry->innovation_rad <= options_.max_innovation_deg * kRadPerDeg;
  entry->binds = entry->innovation_rad <= options_.max_correction_deg * kRadPerDeg;
}

ManhattanId ManhattanFrames::Expect(const Keyframe& keyframe) {
  const auto at = entries_.find(keyframe.id);
  if (at == entries_.end()) return {};
  Judge(keyframe, &at->second);
  return at->second.binds ? frames_[static_cast<size_t>(at->second.frame)].id : ManhattanId();
}

ManhattanMeasurement ManhattanFrames::WithExtra(const Entry& entry) const {
  ManhattanMeasurement measurement = entry.measurement;
  const double extra_rad = frames_[static_cast<size_t>(entry.frame)].extra_sigma_rad;
  measurement.covariance_rad2.diagonal().array() += extra_rad * extra_rad;
  return measurement;
}

// ---- Birth, mean and loss ----

void ManhattanFrames::Update(MapId map_id, OwnedMap* map) {
  std::erase_if(entries_, [map](const auto& entry) { return !map->Find(entry.first); });
  for (auto& [id, entry] : entries_) {
    if (entry.frame < 0) Judge(*map->Find(id), &entry);
  }
  TryBirth(*map);
  Fit(*map);
  ForgetUnconfirmed(map);
  WriteInto(map_id, map);
}

void ManhattanFrames::TryBirth(const Map& map) {
  if (static_cast<int>(entries_.size()) < options_.keyframes_to_birth) return;
  auto at = entries_.rbegin();
  const Eigen::Quaterniond latest =
      WorldFromManhattan(at->second.measurement, *map.Find(at->first));
  MeanRotation mean(latest);
  std::vector<Eigen::Quaterniond> all;
  for (int i = 0; i < options_.keyframes_to_birth; ++i, ++at) {
    if (at->second.binds) return;  // a frame explains it
    const Keyframe& keyframe = *map.Find(at->first);
    Rename(keyframe.cam_from_world.rotation * latest, &at->second.measurement);
    all.push_back(WorldFromManhattan(at->second.measurement, keyframe));
    mean.Add(all.back(), 1.0);
  }
  const Eigen::Quaterniond candidate = mean.Get();
  const double max_spread_rad = options_.max_birth_spread_deg * kRadPerDeg;
  for (const Eigen::Quaterniond& each : all) {
    if (AngleBetween_rad(each, candidate) > max_spread_rad) return;
  }
  frames_.push_back({{}, candidate, options_.min_sigma_deg * kRadPerDeg});
}

void ManhattanFrames::Fit(const Map& map) {
  std::vector<MeanRotation> means;
  for (const Frame& frame : frames_) means.emplace_back(frame.world_from_manhattan);
  for (auto& [id, entry] : entries_) {
    const Keyframe& keyframe = *map.Find(id);
    Judge(keyframe, &entry);
    if (!entry.fits) continue;
    means[static_cast<size_t>(entry.frame)].Add(WorldFromManhattan(entry.measurement, keyframe),
                                                1.0 / WithExtra(entry).covariance_rad2.trace());
  }
  for (size_t i = 0; i < frames_.size(); ++i) {
    frames_[i].world_from_manhattan = means[i].Get();
    LearnExtraSigma(static_cast<int>(i));
  }
}

void ManhattanFrames::LearnExtraSigma(int frame) {
  std::vector<double> innovations_rad;
  for (const auto& [id, entry] : entries_) {
    if (entry.frame == frame) innovations_rad.push_back(entry.innovation_rad);
  }
  if (innovations_rad.empty()) return;
  const auto median = innovations_rad.begin() + std::ssize(innovations_rad) / 2;
  std::nth_element(innovations_rad.begin(), median, innovations_rad.end());
  frames_[static_cast<size_t>(frame)].extra_sigma_rad =
      std::max(options_.min_sigma_deg * kRadPerDeg, *median / std::sqrt(kMedianChi2Dof3));
}

void ManhattanFrames::ForgetUnconfirmed(OwnedMap* map) {
  if (frames_.empty()) return;
  int latest = 0, binding = 0;
  for (auto at = entries_.rbegin(); at != entries_.rend() && latest < options_.loss_window; ++at) {
    ++latest;
    binding += at->second.binds;
  }
  if (latest < options_.loss_window || 2 * binding >= latest) return;
  const auto binds = [](const auto& each) { return each.second.binds; };
  const auto last = std::find_if(entries_.rbegin(), entries_.rend(), binds);
  const int doubtful =
      last == entries_.rend() ? entries_.rbegin()->second.frame : last->second.frame;
  const auto belonging = std::count_if(entries_.begin(), entries_.end(), [&](const auto& each) {
    return binds(each) && each.second.frame == doubtful;
  });
  if (belonging < options_.keyframes_to_confirm) Forget(doubtful, map);
}

void ManhattanFrames::Forget(int frame, OwnedMap* map) {
  const ManhattanId id = frames_[static_cast<size_t>(frame)].id;
  if (id.IsValid()) map->EraseManhattan(id);
  frames_.erase(frames_.begin() + frame);
  // The measurements that led astray are not to bring it to life again.
  std::erase_if(entries_, [&](const auto& each) { return each.second.frame == frame; });
  for (auto& [keyframe, entry] : entries_) {
    if (entry.frame > frame) --entry.frame;
  }
}

void ManhattanFrames::WriteInto(MapId map_id, OwnedMap* map) {
  for (Frame& frame : frames_) {
    if (frame.id.IsValid()) {
      map->SetManhattan(frame.id, frame.world_from_manhattan);
    } else {
      frame.id = map->CreateManhattan(map_id, frame.world_from_manhattan);
    }
  }
  for (const Keyframe& keyframe : map->keyframes()) {
    if (keyframe.map != map_id) continue;
    const auto at = entries_.find(keyframe.id);
    if (at != entries_.end() && at->second.binds) {
      map->SetManhattanOf(keyframe.id, frames_[static_cast<size_t>(at->second.frame)].id);
    } else if (!keyframe.manhattan.IsValid()) {
      // Too few lines to tell: it is where the keyframe is that it hangs on.
      const Keyframe* parent = map->Find(keyframe.parent);
      const bool is_known = parent && parent->manhattan.IsValid();
      map->SetManhattanOf(keyframe.id, is_known          ? parent->manhattan
                                       : frames_.empty() ? ManhattanId()
                                                         : frames_.front().id);
    }
  }
}

}  // namespace vpslam
