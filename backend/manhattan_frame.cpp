#include "backend/manhattan_frame.h"

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

}  // namespace

ManhattanFrame::ManhattanFrame(const ManhattanOptions& options)
    : options_(options), extra_sigma_rad_(options.min_sigma_deg * kRadPerDeg) {}

void ManhattanFrame::Clear() { *this = ManhattanFrame(options_); }

void ManhattanFrame::Absorb(const ManhattanFrame& other,
                            const Eigen::Quaterniond& world_from_other_world) {
  entries_.insert(other.entries_.begin(), other.entries_.end());
  if (!frame_ && other.frame_) frame_ = (world_from_other_world * *other.frame_).normalized();
}

void ManhattanFrame::Add(KeyframeId keyframe, const LineSet& lines) {
  if (!IsSoundManhattan(lines, options_.min_support, options_.max_sigma_deg * kRadPerDeg)) return;
  entries_[keyframe] = {{lines.cam_from_manhattan, lines.covariance_rad2}};
}

std::optional<Eigen::Quaterniond> ManhattanFrame::TurnOf(
    const ManhattanFrame& other, const Eigen::Quaterniond& world_from_other_world,
    const Map& map) const {
  if (!frame_) return std::nullopt;
  std::vector<Eigen::Vector3d> turns;
  for (const auto& [id, entry] : other.entries_) {
    const Keyframe* keyframe = map.Find(id);
    if (!keyframe) continue;
    const Eigen::Quaterniond theirs = NamedNearest(
        world_from_other_world * WorldFromManhattan(entry.measurement, *keyframe), *frame_);
    turns.push_back(LogSo3(*frame_ * theirs.conjugate()));
  }
  const double max_spread_rad = options_.max_birth_spread_deg * kRadPerDeg;
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  int most = 0;
  for (const Eigen::Vector3d& candidate : turns) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int agreeing = 0;
    for (const Eigen::Vector3d& turn : turns) {
      if ((turn - candidate).norm() > max_spread_rad) continue;
      sum += turn;
      ++agreeing;
    }
    if (agreeing > most) {
      most = agreeing;
      best = sum / agreeing;
    }
  }
  if (most < options_.keyframes_to_birth || 2 * most < std::ssize(turns)) return std::nullopt;
  return ExpSo3(best);
}

bool ManhattanFrame::Contradicts(const Eigen::Quaterniond& turn) const {
  return LogSo3(turn).norm() > options_.max_correction_deg * kRadPerDeg;
}

std::optional<ManhattanMeasurement> ManhattanFrame::Find(KeyframeId keyframe) const {
  const auto at = entries_.find(keyframe);
  if (!frame_ || at == entries_.end() || !at->second.binds) return std::nullopt;
  return WithExtra(at->second.measurement);
}

Eigen::Quaterniond ManhattanFrame::Judge(const Keyframe& keyframe, Entry* entry) const {
  Rename(keyframe.cam_from_world.rotation * *frame_, &entry->measurement);
  const Eigen::Quaterniond world = WorldFromManhattan(entry->measurement, keyframe);
  entry->innovation_rad = AngleBetween_rad(world, *frame_);
  entry->fits = entry->innovation_rad <= options_.max_innovation_deg * kRadPerDeg;
  entry->binds = entry->innovation_rad <= options_.max_correction_deg * kRadPerDeg;
  return world;
}

void ManhattanFrame::Expect(const Keyframe& keyframe) {
  const auto at = entries_.find(keyframe.id);
  if (frame_ && at != entries_.end()) Judge(keyframe, &at->second);
}

void ManhattanFrame::Update(const Map& map) {
  std::erase_if(entries_, [&map](const auto& entry) { return !map.Find(entry.first); });
  if (!frame_) TryBirth(map);
  if (frame_) Fit(map);
}

void ManhattanFrame::TryBirth(const Map& map) {
  if (static_cast<int>(entries_.size()) < options_.keyframes_to_birth) return;
  auto at = entries_.rbegin();
  const Eigen::Quaterniond latest =
      WorldFromManhattan(at->second.measurement, *map.Find(at->first));
  MeanRotation mean(latest);
  std::vector<Eigen::Quaterniond> all;
  for (int i = 0; i < options_.keyframes_to_birth; ++i, ++at) {
    const Keyframe& keyframe = *map.Find(at->first);
    Rename(keyframe.cam_from_world.rotation * latest, &at->second.measurement);
    all.push_back(WorldFromManhattan(at->second.measurement, keyframe));
    mean.Add(all.back(), 1.0);
  }
  const Eigen::Quaterniond candidate = mean.Get();
  const double max_spread = options_.max_birth_spread_deg * kRadPerDeg;
  if (std::all_of(all.begin(), all.end(), [&](const Eigen::Quaterniond& q) {
        return AngleBetween_rad(q, candidate) <= max_spread;
      })) {
    frame_ = candidate;
  }
}

void ManhattanFrame::Fit(const Map& map) {
  MeanRotation mean(*frame_);
  for (auto& [id, entry] : entries_) {
    const Eigen::Quaterniond world = Judge(*map.Find(id), &entry);
    if (entry.fits) mean.Add(world, 1.0 / WithExtra(entry.measurement).covariance_rad2.trace());
  }
  int latest = 0, binding = 0;
  for (auto at = entries_.rbegin(); at != entries_.rend() && latest < options_.loss_window; ++at) {
    ++latest;
    binding += at->second.binds;
  }
  if (latest == options_.loss_window && 2 * binding < latest) {
    Clear();
  } else {
    frame_ = mean.Get();
    LearnExtraSigma();
  }
}

ManhattanMeasurement ManhattanFrame::WithExtra(ManhattanMeasurement measurement) const {
  measurement.covariance_rad2.diagonal().array() += extra_sigma_rad_ * extra_sigma_rad_;
  return measurement;
}

void ManhattanFrame::LearnExtraSigma() {
  if (entries_.empty()) return;
  std::vector<double> innovations_rad;
  for (const auto& [id, entry] : entries_) innovations_rad.push_back(entry.innovation_rad);
  const auto median = innovations_rad.begin() + std::ssize(innovations_rad) / 2;
  std::nth_element(innovations_rad.begin(), median, innovations_rad.end());
  extra_sigma_rad_ =
      std::max(options_.min_sigma_deg * kRadPerDeg, *median / std::sqrt(kMedianChi2Dof3));
}

}  // namespace vpslam
