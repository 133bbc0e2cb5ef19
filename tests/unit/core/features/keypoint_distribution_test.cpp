#include "core/features/keypoint_distribution.h"

#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

const cv::Size kSize(640, 480);

/// Strong corners crowd in the left tenth, weak ones are everywhere.
std::vector<Corner> CrowdedCorners(int n, unsigned seed) {
  std::mt19937 rng(seed);
  std::set<std::pair<int, int>> positions;
  std::vector<Corner> corners;
  while (static_cast<int>(corners.size()) < n) {
    const bool strong = corners.size() % 2 == 0;
    const int x = std::uniform_int_distribution<int>(0, strong ? 63 : 639)(rng);
    const int y = std::uniform_int_distribution<int>(0, 479)(rng);
    const int score = std::uniform_int_distribution<int>(strong ? 60 : 8, strong ? 200 : 30)(rng);
    if (positions.insert({x, y}).second) corners.push_back({x, y, score});
  }
  return corners;
}

int OccupiedCells(const std::vector<Corner>& corners, int cell_px) {
  std::set<std::pair<int, int>> cells;
  for (const Corner& c : corners) cells.insert({c.x / cell_px, c.y / cell_px});
  return static_cast<int>(cells.size());
}

TEST(KeypointDistribution, CoversTheWholeImage) {
  const std::vector<Corner> all = CrowdedCorners(4000, 1);
  std::vector<Corner> corners = all;
  KeypointDistribution().Select(kSize, 300, &corners);
  ASSERT_EQ(corners.size(), 300u);
  // Of 165 cells. The 300 strongest corners lie in 22 of them.
  EXPECT_GT(OccupiedCells(corners, 45), 130);
}

TEST(KeypointDistribution, PrefersTheStrong) {
  const std::vector<Corner> all = CrowdedCorners(4000, 2);
  std::vector<Corner> kept = all;
  KeypointDistribution().Select(kSize, 300, &kept);
  int strong = 0;
  for (const Corner& c : kept) strong += c.score >= 60;
  EXPECT_GT(strong, 50);  // an even spread has 30 of them, in the left tenth
  // Nobody who was left out is stronger than all that were kept around it: fair spacing is 32 px,
  // cells are 39 px wide.
  for (const Corner& c : all) {
    int strongest = 0;
    for (const Corner& k : kept) {
      if (std::abs(k.x - c.x) <= 39 && std::abs(k.y - c.y) <= 39) {
        strongest = std::max(strongest, k.score);
      }
    }
    EXPECT_GE(strongest, c.score) << c.x << " " << c.y;
  }
}

TEST(KeypointDistribution, KeepsADistanceIfThereAreEnough) {
  std::vector<Corner> corners = CrowdedCorners(4000, 3);
  KeypointDistribution({.min_spacing = 0.4}).Select(kSize, 200, &corners);
  // 0.4 x 39 px, less a cell by which the square may lie off centre.
  for (size_t i = 0; i < corners.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      EXPECT_GT(
          std::max(std::abs(corners[i].x - corners[j].x), std::abs(corners[i].y - corners[j].y)),
          14);
    }
  }
}

TEST(KeypointDistribution, GivesExactlyTheNumberWantedIfItCan) {
  for (const int wanted : {0, 1, 2, 17, 250, 1999, 2000, 2001, 5000}) {
    std::vector<Corner> corners = CrowdedCorners(2000, 4);
    KeypointDistribution().Select(kSize, wanted, &corners);
    EXPECT_EQ(static_cast<int>(corners.size()), std::min(wanted, 2000));
    std::set<std::pair<int, int>> distinct;
    for (const Corner& c : corners) distinct.insert({c.x, c.y});
    EXPECT_EQ(distinct.size(), corners.size());
  }
}

TEST(DistributionOptions, ValidateNamesTheFault) {
  EXPECT_FALSE(DistributionOptions().Validate());
  EXPECT_TRUE(DistributionOptions{.min_spacing = -1}.Validate());
  EXPECT_TRUE(DistributionOptions{.cell = 0}.Validate());
}

TEST(KeypointDistribution, NoCorners) {
  std::vector<Corner> corners;
  KeypointDistribution().Select(kSize, 100, &corners);
  EXPECT_TRUE(corners.empty());
}

TEST(ShareOut, FollowsTheSeriesWhereThereIsEnough) {
  const std::vector<int> shares = ShareOut(1000, 1.2, std::vector<int>(8, 10000));
  EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), 0), 1000);
  for (size_t i = 1; i < shares.size(); ++i) EXPECT_NEAR(shares[i], shares[i - 1] / 1.2, 1.6);
}

TEST(ShareOut, WhatALevelLacksTheOthersGive) {
  const std::vector<int> available{30, 10000, 5, 10000, 0, 0, 60, 2};
  const std::vector<int> shares = ShareOut(1000, 1.2, available);
  EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), 0), 1000);
  for (size_t i = 0; i < shares.size(); ++i) EXPECT_LE(shares[i], available[i]);
  EXPECT_EQ(shares[0], 30);
  EXPECT_NEAR(shares[3], shares[1] / 1.44, 2.0);
}

TEST(ShareOut, TooFewAltogether) {
  const std::vector<int> available{30, 7, 0, 12};
  EXPECT_EQ(ShareOut(1000, 1.2, available), available);
  EXPECT_TRUE(ShareOut(1000, 1.2, {}).empty());
  EXPECT_EQ(ShareOut(0, 1.2, available), std::vector<int>(4, 0));
}

}  // namespace
}  // namespace vpslam
