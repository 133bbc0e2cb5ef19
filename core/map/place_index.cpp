#include "core/map/place_index.h"

#include <algorithm>

#include "core/map/votes.h"

namespace vpslam {
namespace {

constexpr int kPieces = 16;
constexpr int kValues = 1 << 16;

int Piece(const Descriptor& d, int piece) {
  return static_cast<int>((d[piece / 4] >> (16 * (piece % 4))) & 0xffff);
}

}  // namespace

void PlaceIndex::Update(const Map& map, const std::vector<MapId>& except) {
  if (version_ == map.version() && except_ == except && version_ > 0) return;
  version_ = map.version();
  except_ = except;
  points_.clear();
  descriptors_.clear();
  for (const MapPoint& point : map.points()) {
    if (std::binary_search(except.begin(), except.end(), point.map)) continue;
    points_.push_back(point.id);
    descriptors_.push_back(point.descriptor);
  }
  const auto n = static_cast<int32_t>(points_.size());
  begin_.assign(n > 0 ? kPieces * (kValues + 1) : 0, 0);
  members_.resize(static_cast<size_t>(kPieces) * n);
  for (int piece = 0; piece < kPieces && n > 0; ++piece) {
    int32_t* begin = &begin_[piece * (kValues + 1)];
    for (const Descriptor& d : descriptors_) ++begin[Piece(d, piece) + 1];
    begin[0] = piece * n;
    for (int v = 0; v < kValues; ++v) begin[v + 1] += begin[v];
    std::vector<int32_t> next(begin, begin + kValues);
    for (int32_t i = 0; i < n; ++i) members_[next[Piece(descriptors_[i], piece)]++] = i;
  }
}

int PlaceIndex::Nearest(const Descriptor& descriptor, std::vector<int>* compared_with,
                        int query) const {
  // A value that so many points share says nothing.
  const int too_common = 32 + static_cast<int>(points_.size()) / 64;
  int best = -1, best_distance = options_.max_distance + 1;
  for (int piece = 0; piece < kPieces; ++piece) {
    const int32_t* begin = &begin_[piece * (kValues + 1) + Piece(descriptor, piece)];
    if (begin[1] - begin[0] > too_common) continue;
    for (int32_t m = begin[0]; m < begin[1]; ++m) {
      const int i = members_[m];
      if ((*compared_with)[i] == query) continue;
      (*compared_with)[i] = query;
      const int distance = Distance(descriptor, descriptors_[i]);
      if (distance < best_distance || (distance == best_distance && i < best)) {
        best = i;
        best_distance = distance;
      }
    }
  }
  return best;
}

std::vector<std::pair<KeyframeId, int>> PlaceIndex::Query(const Map& map,
                                                          std::span<const Descriptor> descriptors,
                                                          int max_candidates) const {
  std::vector<std::pair<KeyframeId, int>> candidates;
  if (points_.empty()) return candidates;
  std::vector<int> compared_with(points_.size(), -1);
  std::vector<const MapPoint*> shown;
  for (size_t i = 0; i < descriptors.size(); ++i) {
    const int nearest = Nearest(descriptors[i], &compared_with, static_cast<int>(i));
    if (nearest >= 0) shown.push_back(map.Find(points_[nearest]));
  }
  while (static_cast<int>(candidates.size()) < max_candidates) {
    Votes votes(map.keyframes());
    for (const MapPoint* point : shown) {
      for (const Observation& o : point->observations) votes.Add(o.keyframe);
    }
    const auto ranked = votes.Ranked();
    if (ranked.empty() || ranked.front().second < options_.min_votes) break;
    const KeyframeId keyframe = ranked.front().first;
    candidates.push_back(ranked.front());
    std::erase_if(shown, [keyframe](const MapPoint* point) {
      return std::any_of(point->observations.begin(), point->observations.end(),
                         [keyframe](const Observation& o) { return o.keyframe == keyframe; });
    });
  }
  return candidates;
}

}  // namespace vpslam
