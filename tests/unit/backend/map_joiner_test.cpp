#include "backend/map_joiner.h"

#include <gtest/gtest.h>

#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

/// Two maps of one scene, of keyframes that stand 0.3 apart: map 0 from -1.2 to 0, map 1 from 0.15
/// to 1.35, in coordinates of its own.
class TwoMaps {
 public:
  explicit TwoMaps(uint64_t seed, double outlier_share = 0)
      : scene(seed, {.num_points = 1200}), maps(scene), outlier_share_(outlier_share) {
    Build(MapId(0), -1.2);
    Build(MapId(1), 0.15);
    maps.map.Transform(MapId(1), elsewhere);
  }

  const Sim3 elsewhere{ExpSo3({0.2, 1.5, -0.3}), {4, -3, 2}, 0.4};
  SyntheticScene scene;
  SyntheticMap maps;
  MergingOptions options;

  /// Of the first keyframe of map 1, found in map 0 with a pose a bit off.
  MapSeam Seam() {
    MapSeam seam;
    seam.map = MapId(0);
    seam.cam_from_world = scene.Disturbed(maps.views.at(first_of_1_).cam_from_world, 0.01, 0.002);
    const SyntheticView& view = maps.views.at(first_of_1_);
    for (int f = 0; f < view.features.size(); ++f) {
      if (view.point[f] < 0 || !of_map_0_.contains(view.point[f])) continue;
      PointId id = of_map_0_.at(view.point[f]);
      if (scene.Uniform(0, 1) < outlier_share_) id = std::next(of_map_0_.begin(), 7)->second;
      seam.points.push_back({f, id});
    }
    return seam;
  }
  std::optional<SeamAlignment> Align(const MapSeam& seam) {
    return AlignSeam(maps.Context(), first_of_1_, seam, options);
  }
  KeyframeId first_of_1() const { return first_of_1_; }

 private:
  void Build(MapId id, double begin) {
    maps.map_id = id;
    std::vector<KeyframeId> keyframes;
    for (int i = 0; i < 5; ++i) {
      keyframes.push_back(maps.AddKeyframe(scene.Look(PoseAt({begin + 0.3 * i, 0, 0}))));
    }
    if (id == MapId(1)) first_of_1_ = keyframes.front();
    for (int p = 0; p < static_cast<int>(scene.points.size()); ++p) {
      const Eigen::Vector3d noise = scene.NormalVector(0.01);
      const PointId point = maps.AddPoint(p, scene.points[p].position + noise, keyframes);
      if (id == MapId(0) && point.IsValid()) of_map_0_[p] = point;
    }
  }

  double outlier_share_;
  KeyframeId first_of_1_;
  std::map<int, PointId> of_map_0_;
};

/// How far apart two similarities put points of the scene, at most.
double Difference(const Sim3& a, const Sim3& b) {
  double most = 0;
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0, 0, 5), Eigen::Vector3d(3, 2, 8), Eigen::Vector3d(-3, -2, 3)}) {
    const Eigen::Vector3d there = b.Inverse() * x;
    most = std::max(most, (a * there - x).norm());
  }
  return most;
}

TEST(MapJoiner, FindsTheSimilarity) {
  for (const double outliers : {0.0, 0.3}) {
    TwoMaps m(1, outliers);
    const MapSeam seam = m.Seam();
    const auto alignment = m.Align(seam);
    ASSERT_TRUE(alignment);
    // A hundred points that err by 0.01 and as many pixels' worth, looked at from all over.
    EXPECT_LT(Difference(alignment->there_from_here, m.elsewhere.Inverse()), 0.03);
    EXPECT_NEAR(alignment->there_from_here.scale, 1 / 0.4, 0.01 / 0.4);
    const double right = (1 - outliers) * static_cast<double>(seam.points.size());
    EXPECT_GT(static_cast<double>(alignment->points.size()), 0.9 * right);
    EXPECT_LT(static_cast<double>(alignment->points.size()), 1.1 * right);
  }
}

TEST(MapJoiner, WhatDoesNotAgreeIsNoSeam) {
  TwoMaps few(2);
  MapSeam seam = few.Seam();
  seam.points.resize(few.options.min_common_points - 1);
  EXPECT_FALSE(few.Align(seam));

  TwoMaps wrong(2, 0.8);
  EXPECT_FALSE(wrong.Align(wrong.Seam())) << "most pairs are of different points";

  TwoMaps itself(2);
  seam = itself.Seam();
  seam.map = MapId(1);
  EXPECT_FALSE(itself.Align(seam));
  itself.maps.map.EraseMap(MapId(0));
  EXPECT_FALSE(itself.Align(itself.Seam())) << "gone meanwhile";
}

TEST(MapJoiner, TheYoungerMapJoinsTheOlder) {
  TwoMaps m(3);
  const auto alignment = m.Align(m.Seam());
  ASSERT_TRUE(alignment);
  OwnedMap& map = m.maps.map;
  const int points = map.NumPoints(MapId(0)) + map.NumPoints(MapId(1));
  const Eigen::Vector3d anchor = map.Find(KeyframeId(0))->Center();
  const Merger merger = MergerOf(MapId(1), MapId(0), alignment->there_from_here);
  JoinMaps(merger, alignment->points, &map);
  EXPECT_EQ(merger.from, MapId(1));
  EXPECT_EQ(merger.into, MapId(0));
  EXPECT_EQ(map.Maps(), std::vector<MapId>{MapId(0)});
  EXPECT_EQ(map.NumPoints(MapId(0)), points - static_cast<int>(alignment->points.size()));
  EXPECT_EQ(map.Find(KeyframeId(0))->Center(), anchor) << "the older one stays where it is";
  for (const auto& [id, view] : m.maps.views) {
    EXPECT_LT((map.Find(id)->Center() - view.cam_from_world.Center()).norm(), 0.03);
  }
  // The two halves know of each other now.
  EXPECT_GT(map.Covisible(m.first_of_1(), 15).size(), 5u);
}

TEST(MapJoiner, FromTheOlderMapsSide) {
  TwoMaps m(4);
  const auto alignment = m.Align(m.Seam());
  ASSERT_TRUE(alignment);
  // The seam is a keyframe of map 0 that was found in map 1: the same pairs, the other way round.
  std::vector<CommonPoint> reversed;
  for (const CommonPoint& c : alignment->points) reversed.push_back({c.there, c.here});
  const Merger merger = MergerOf(MapId(0), MapId(1), alignment->there_from_here.Inverse());
  JoinMaps(merger, reversed, &m.maps.map);
  EXPECT_EQ(merger.from, MapId(1));
  EXPECT_EQ(merger.into, MapId(0));
  EXPECT_LT(Difference(merger.into_from, m.elsewhere.Inverse()), 0.03);
}

TEST(MapJoiner, WhatCameFromAMapMovesWithoutTheRest) {
  TwoMaps m(5);
  const auto alignment = m.Align(m.Seam());
  ASSERT_TRUE(alignment);
  OwnedMap& map = m.maps.map;
  const LineId line = map.CreateLine(MapId(1), m.first_of_1(), {0, 0, 1}, {1, 0, 1});
  const MapContents of_1 = ContentsOf(MapId(1), map);
  EXPECT_EQ(of_1.keyframes.size(), 5u);
  EXPECT_EQ(static_cast<int>(of_1.points.size()), map.NumPoints(MapId(1)));
  EXPECT_EQ(of_1.lines, std::vector<LineId>{line});
  JoinMaps(MergerOf(MapId(1), MapId(0), alignment->there_from_here), alignment->points, &map);
  const Map before = map;
  const SE3 turn(ExpSo3({0, 0.05, 0}), {0.1, 0, 0});
  Transform(of_1, turn, &map);
  int moved = 0;
  for (const auto& [id, view] : m.maps.views) {
    const bool is_of_1 = id >= m.first_of_1();
    const Eigen::Vector3d was = before.Find(id)->Center();
    EXPECT_LT((map.Find(id)->Center() - (is_of_1 ? turn * was : was)).norm(), 1e-9);
  }
  for (const PointId id : of_1.points) {
    if (!map.Find(id)) continue;  // fused into one of map 0
    ++moved;
    const Eigen::Vector3d expected = turn * before.Find(id)->position;
    EXPECT_LT((map.Find(id)->position - expected).norm(), 1e-9);
    const Eigen::Vector3d normal = turn.rotation * before.Find(id)->normal;
    EXPECT_LT((map.Find(id)->normal - normal).norm(), 1e-9);
  }
  EXPECT_GT(moved, 20);
  EXPECT_LT((map.Find(line)->end - turn * before.Find(line)->end).norm(), 1e-9);
}

}  // namespace
}  // namespace vpslam
