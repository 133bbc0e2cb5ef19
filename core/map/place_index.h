// Which keyframes show what an image shows, judged by descriptors alone: an inverted index over the
// points of a map. Needs no vocabulary and no training.
//
// Multi-index hashing: M. Norouzi, A. Punjani, D. Fleet, "Fast search in Hamming space with
// multi-index hashing", CVPR 2012. A descriptor is cut into 16 pieces of 16 bits; points that agree
// with it in a piece are compared in full. Two descriptors that differ in fewer than 16 bits always
// meet, at 40 bits two in three do. The result depends on the arguments alone.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/features/features.h"
#include "core/map/map.h"

namespace vpslam {

struct PlaceIndexOptions {
  int max_distance = 50;  ///< Hamming, between feature and point
  int min_votes = 10;     ///< features that show points of a keyframe, for it to be named

  template <class V>
  void Visit(V& v) {
    v("max_distance", max_distance);
    v("min_votes", min_votes);
  }
};

class PlaceIndex {
 public:
  explicit PlaceIndex(const PlaceIndexOptions& options = {}) : options_(options) {}

  /// Over the points of all maps but those in `except` (ascending). Costs a few milliseconds;
  /// nothing if nothing has changed since the last call.
  void Update(const Map& map, const std::vector<MapId>& except);

  /// Keyframes with their votes, most first, ties by id, at most max_candidates. What one keyframe
  /// explains does not count for the next, so that they are of different places, if possible.
  /// `map`: as Update had it.
  std::vector<std::pair<KeyframeId, int>> Query(const Map& map,
                                                std::span<const Descriptor> descriptors,
                                                int max_candidates) const;

 private:
  /// The point nearest to the descriptor, an index into points_; -1 if none is near.
  int Nearest(const Descriptor& descriptor, std::vector<int>* compared_with, int query) const;

  PlaceIndexOptions options_;
  int64_t version_ = -1;
  std::vector<MapId> except_;
  std::vector<PointId> points_;
  std::vector<Descriptor> descriptors_;
  /// Of piece p, the points in whose descriptors it has the value v:
  /// members_[i] with begin_[p * (2^16 + 1) + v] <= i < the next.
  std::vector<int32_t> begin_, members_;
};

}  // namespace vpslam
