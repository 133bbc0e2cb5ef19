#include "core/map/place_index.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "core/map/owned_map.h"
#include "tests/unit/table_end.h"

namespace vpslam {
namespace {

class Places {
 public:
  explicit Places(uint64_t seed) : rng(seed) {}

  std::mt19937_64 rng;
  OwnedMap map;

  Descriptor Random() { return {rng(), rng(), rng(), rng()}; }
  Descriptor Flipped(Descriptor d, int bits) {
    for (int i = 0; i < bits; ++i) {
      const uint64_t bit = rng() % 256;
      d[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    return d;
  }
  /// `num_keyframes` that share their points in pairs.
  void AddPlace(MapId id, int num_keyframes, int num_points) {
    std::vector<KeyframeId> keyframes;
    for (int i = 0; i < num_keyframes; ++i) {
      Keyframe keyframe;
      keyframe.id = KeyframeId(KeyframeEnd(map));
      keyframe.map = id;
      keyframe.points.resize(2 * num_points);
      map.Insert(keyframe);
      keyframes.push_back(keyframe.id);
    }
    for (int i = 0; i + 1 < num_keyframes; ++i) {
      for (int p = 0; p < num_points; ++p) {
        const PointId point = map.CreatePoint(id, keyframes[i], {0, 0, 1});
        map.SetDescriptor(point, Random());
        map.Observe(keyframes[i], num_points + p, point);
        map.Observe(keyframes[i + 1], p, point);
      }
    }
    map.TakeDeltas(KeyframeId(), {});
  }
  /// What an image shows that sees what the keyframe saw, and clutter.
  std::vector<Descriptor> View(KeyframeId keyframe, int bits, int clutter) {
    std::vector<Descriptor> view;
    for (const PointId id : map.Find(keyframe)->points) {
      if (const MapPoint* point = map.Find(id)) view.push_back(Flipped(point->descriptor, bits));
    }
    for (int i = 0; i < clutter; ++i) view.push_back(Random());
    return view;
  }
};

TEST(PlaceIndex, NamesTheKeyframeThatShowsMost) {
  Places p(1);
  p.AddPlace(MapId(0), 40, 100);
  PlaceIndex index;
  index.Update(p.map, {});
  for (int k = 1; k < 39; ++k) {
    const auto found = index.Query(p.map, p.View(KeyframeId(k), 25, 500), 3);
    ASSERT_FALSE(found.empty()) << k;
    EXPECT_EQ(found.front().first, KeyframeId(k));
    // Of 200 points; at 25 bits nine in ten meet at least.
    EXPECT_GT(found.front().second, 180);
    for (const auto& [other, votes] : found) EXPECT_LE(votes, found.front().second);
  }
}

TEST(PlaceIndex, CandidatesAreOfDifferentPlaces) {
  Places p(2);
  p.AddPlace(MapId(0), 5, 100);
  p.AddPlace(MapId(1), 5, 100);
  PlaceIndex index;
  index.Update(p.map, {});
  std::vector<Descriptor> view = p.View(KeyframeId(2), 20, 0);
  const std::vector<Descriptor> other = p.View(KeyframeId(7), 20, 0);
  view.insert(view.end(), other.begin(), other.begin() + 150);
  const auto found = index.Query(p.map, view, 5);
  ASSERT_EQ(found.size(), 2u) << "neighbours see what these two see, and no more";
  EXPECT_EQ(found[0].first, KeyframeId(2));
  EXPECT_EQ(found[1].first, KeyframeId(7));
  EXPECT_EQ(index.Query(p.map, view, 1).size(), 1u);
}

TEST(PlaceIndex, MapsThatAreLeftOutAndPlacesThatAreUnknown) {
  Places p(3);
  p.AddPlace(MapId(0), 5, 100);
  p.AddPlace(MapId(1), 5, 100);
  PlaceIndex index;
  const auto view = p.View(KeyframeId(7), 20, 0);
  index.Update(p.map, {MapId(1)});
  EXPECT_TRUE(index.Query(p.map, view, 3).empty());
  index.Update(p.map, {MapId(0)});
  EXPECT_FALSE(index.Query(p.map, view, 3).empty());
  index.Update(p.map, {MapId(0), MapId(1)});
  EXPECT_TRUE(index.Query(p.map, view, 3).empty());
  index.Update(p.map, {});
  std::vector<Descriptor> alien(1000);
  std::generate(alien.begin(), alien.end(), [&] { return p.Random(); });
  EXPECT_TRUE(index.Query(p.map, alien, 3).empty());
  EXPECT_TRUE(index.Query(p.map, {}, 3).empty());
  EXPECT_TRUE(PlaceIndex().Query(p.map, view, 3).empty()) << "nothing in it";
}

TEST(PlaceIndex, FollowsTheMap) {
  Places p(4);
  p.AddPlace(MapId(0), 3, 100);
  PlaceIndex index;
  index.Update(p.map, {});
  p.AddPlace(MapId(0), 3, 100);
  const auto view = p.View(KeyframeId(4), 10, 0);
  EXPECT_TRUE(index.Query(p.map, view, 3).empty());
  index.Update(p.map, {});
  ASSERT_FALSE(index.Query(p.map, view, 3).empty());
  EXPECT_EQ(index.Query(p.map, view, 3).front().first, KeyframeId(4));
}

}  // namespace
}  // namespace vpslam
