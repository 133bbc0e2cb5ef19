#include "core/features/matcher.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

constexpr Camera::Bounds kBounds{0, 0, 640, 480};

Descriptor RandomDescriptor(std::mt19937_64& rng) { return {rng(), rng(), rng(), rng()}; }

/// The descriptor with `n` bits turned over.
Descriptor Disturbed(Descriptor d, int n, std::mt19937_64& rng) {
  std::set<int> bits;
  while (static_cast<int>(bits.size()) < n) bits.insert(static_cast<int>(rng() % 256));
  for (const int b : bits) d[b / 64] ^= uint64_t{1} << (b % 64);
  return d;
}

/// Two images with a known permutation between them: feature i of the first is permutation[i] of
/// the second, moved by (5, -3) px.
struct Pair {
  Features first, second;
  std::vector<int> permutation;
  FeatureGrid grid;
  std::vector<Eigen::Vector2f> predicted_px;
};

Pair MakePair(int n, int max_octave, int noise_bits, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<float> x(20.f, 600.f), y(20.f, 450.f), angle(0.f, 6.28f);
  Pair pair;
  pair.permutation.resize(n);
  for (int i = 0; i < n; ++i) pair.permutation[i] = i;
  std::shuffle(pair.permutation.begin(), pair.permutation.end(), rng);
  pair.second.keypoints.resize(n);
  pair.second.descriptors.resize(n);
  for (int i = 0; i < n; ++i) {
    Keypoint k{x(rng), y(rng), angle(rng), 30.f, static_cast<int>(rng() % (max_octave + 1))};
    const Descriptor d = RandomDescriptor(rng);
    pair.first.keypoints.push_back(k);
    pair.first.descriptors.push_back(d);
    pair.predicted_px.emplace_back(k.x_px, k.y_px);
    k.x_px += 5;
    k.y_px -= 3;
    pair.second.keypoints[pair.permutation[i]] = k;
    pair.second.descriptors[pair.permutation[i]] = Disturbed(d, noise_bits, rng);
  }
  pair.grid = FeatureGrid(pair.second.keypoints, kBounds);
  return pair;
}

void ExpectOneToOneAndOrdered(const std::vector<Match>& matches) {
  std::set<int> seconds;
  for (size_t i = 0; i < matches.size(); ++i) {
    EXPECT_TRUE(seconds.insert(matches[i].second).second);
    if (i > 0) {
      EXPECT_LT(matches[i - 1].first, matches[i].first);
    }
  }
}

TEST(Distance, CountsTheBitsThatDiffer) {
  std::mt19937_64 rng(1);
  for (int n = 0; n <= 256; n += 16) {
    const Descriptor d = RandomDescriptor(rng);
    EXPECT_EQ(Distance(d, Disturbed(d, n, rng)), n);
  }
}

TEST(MatchForInitialisation, FindsThePermutation) {
  const Pair pair = MakePair(400, 0, 30, 2);
  const std::vector<Match> matches =
      MatchForInitialisation(pair.first, pair.second, pair.grid, pair.predicted_px);
  EXPECT_EQ(matches.size(), 400u);
  for (const Match& m : matches) EXPECT_EQ(m.second, pair.permutation[m.first]);
  ExpectOneToOneAndOrdered(matches);
}

TEST(MatchForInitialisation, AllOctavesCount) {
  const Pair pair = MakePair(400, 7, 30, 3);
  EXPECT_EQ(MatchForInitialisation(pair.first, pair.second, pair.grid, pair.predicted_px).size(),
            400u);
}

TEST(MatchForInitialisation, NothingBeyondTheWindow) {
  Pair pair = MakePair(100, 0, 0, 4);
  for (Eigen::Vector2f& p : pair.predicted_px) p.x() += 106;
  EXPECT_TRUE(
      MatchForInitialisation(pair.first, pair.second, pair.grid, pair.predicted_px).empty());
}

TEST(MatchForInitialisation, TheNearerOfTwoClaimantsWins) {
  std::mt19937_64 rng(5);
  const Descriptor d = RandomDescriptor(rng);
  Features first, second;
  first.keypoints.resize(2);
  first.descriptors = {Disturbed(d, 30, rng), Disturbed(d, 10, rng)};
  second.keypoints.resize(1);
  second.descriptors = {d};
  const std::vector<Eigen::Vector2f> predicted_px(2, Eigen::Vector2f::Zero());
  const FeatureGrid grid(second.keypoints, kBounds);
  const std::vector<Match> expected{{1, 0}};
  EXPECT_EQ(MatchForInitialisation(first, second, grid, predicted_px), expected);
  std::swap(first.descriptors[0], first.descriptors[1]);
  const std::vector<Match> swapped{{0, 0}};
  EXPECT_EQ(MatchForInitialisation(first, second, grid, predicted_px), swapped);
}

TEST(MatchForInitialisation, LookAlikesAreNoMatch) {
  std::mt19937_64 rng(6);
  const Descriptor d = RandomDescriptor(rng);
  Features first, second;
  first.keypoints.resize(1);
  first.descriptors = {Disturbed(d, 20, rng)};
  second.keypoints.resize(2);
  second.descriptors = {d, d};
  const std::vector<Eigen::Vector2f> predicted_px(1, Eigen::Vector2f::Zero());
  EXPECT_TRUE(
      MatchForInitialisation(first, second, FeatureGrid(second.keypoints, kBounds), predicted_px)
          .empty());
}

TEST(MatchForInitialisation, WhatIsTakenIsStillARival) {
  std::mt19937_64 rng(8);
  const Descriptor d = RandomDescriptor(rng);
  Features first, second;
  first.keypoints.resize(2);
  first.descriptors = {d, Disturbed(d, 10, rng)};
  second.keypoints.resize(2);
  second.descriptors = {d, Disturbed(first.descriptors[1], 11, rng)};
  const std::vector<Eigen::Vector2f> predicted_px(2, Eigen::Vector2f::Zero());
  const std::vector<Match> expected{{0, 0}};
  EXPECT_EQ(MatchForInitialisation(first, second, FeatureGrid(second.keypoints, kBounds),
                                   predicted_px, {.check_rotation = false}),
            expected);
}

TEST(MatchForInitialisation, WhatTurnedOtherwiseIsDropped) {
  Pair pair = MakePair(300, 0, 20, 7);
  for (int i = 0; i < 300; i += 10)
    pair.second.keypoints[pair.permutation[i]].angle_rad += 2.0f + 0.1f * static_cast<float>(i);
  const std::vector<Match> all = MatchForInitialisation(
      pair.first, pair.second, pair.grid, pair.predicted_px, {.check_rotation = false});
  EXPECT_EQ(all.size(), 300u);
  const std::vector<Match> kept =
      MatchForInitialisation(pair.first, pair.second, pair.grid, pair.predicted_px);
  EXPECT_GE(kept.size(), 270u);
  EXPECT_LE(kept.size(), 275u);
}

TEST(BestMatchInWindow, FindsTheBestAndTheRunnerUp) {
  std::mt19937_64 rng(8);
  const Descriptor d = RandomDescriptor(rng);
  Features features;
  features.keypoints = {{.x_px = 100, .y_px = 100, .octave = 2},
                        {.x_px = 104, .y_px = 100, .octave = 2},
                        {.x_px = 100, .y_px = 104, .octave = 3},
                        {.x_px = 300, .y_px = 100, .octave = 2}};
  features.descriptors = {Disturbed(d, 40, rng), Disturbed(d, 24, rng), Disturbed(d, 30, rng), d};
  const FeatureGrid grid(features.keypoints, kBounds);
  WindowQuery query{.x_px = 101, .y_px = 101, .radius_px = 15};

  auto match = BestMatchInWindow(d, query, features, grid);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->index, 1);
  EXPECT_EQ(match->distance, 24);
  EXPECT_EQ(match->second_distance, 30);

  // The runner-up is of another octave: no ratio test.
  query.ratio = 0.7f;
  match = BestMatchInWindow(d, query, features, grid);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->index, 1);
  // Of the same octave: 24 < 0.7 x 40, but not < 0.5 x 40.
  query.octaves = {1, 2};
  EXPECT_TRUE(BestMatchInWindow(d, query, features, grid));
  query.ratio = 0.5f;
  EXPECT_FALSE(BestMatchInWindow(d, query, features, grid));

  query.ratio = 1.0f;
  query.max_distance = 23;
  EXPECT_FALSE(BestMatchInWindow(d, query, features, grid));
  query.max_distance = 100;
  const std::vector<uint8_t> taken{0, 1, 0, 0};
  match = BestMatchInWindow(d, query, features, grid, taken);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->index, 0);
  EXPECT_EQ(match->second_distance, 256);
  EXPECT_FALSE(BestMatchInWindow(d, query, features, grid, std::vector<uint8_t>(4, 1)));
  query.x_px = 500;
  EXPECT_FALSE(BestMatchInWindow(d, query, features, grid));
}

TEST(MatchByDescriptor, FindsThePermutation) {
  const Pair pair = MakePair(500, 7, 40, 9);
  const std::vector<Match> matches =
      MatchByDescriptor(pair.first.descriptors, pair.second.descriptors);
  EXPECT_EQ(matches.size(), 500u);
  for (const Match& m : matches) EXPECT_EQ(m.second, pair.permutation[m.first]);
  ExpectOneToOneAndOrdered(matches);
}

TEST(MatchByDescriptor, AgreesWithTheDefinition) {
  // Families of descriptors that differ in few bits, so that many distances are equal.
  std::mt19937_64 rng(10);
  std::vector<Descriptor> families(20), first(80), second(90);
  for (Descriptor& d : families) d = RandomDescriptor(rng);
  for (Descriptor& d : first) d = Disturbed(families[rng() % 20], static_cast<int>(rng() % 9), rng);
  for (Descriptor& d : second)
    d = Disturbed(families[rng() % 20], static_cast<int>(rng() % 9), rng);
  const DescriptorMatchOptions options{.max_distance = 12, .ratio = 0.99f};
  std::vector<Match> expected;
  for (int i = 0; i < 80; ++i) {
    std::vector<std::pair<int, int>> row;
    for (int j = 0; j < 90; ++j) row.emplace_back(Distance(first[i], second[j]), j);
    std::sort(row.begin(), row.end());
    const auto [distance, j] = row[0];
    if (distance > options.max_distance) continue;
    if (static_cast<float>(distance) >= options.ratio * static_cast<float>(row[1].first)) continue;
    bool mutual = true;
    for (int k = 0; k < 80; ++k) {
      const int other = Distance(first[k], second[j]);
      mutual = mutual && (other > distance || (other == distance && k >= i));
    }
    if (mutual) expected.push_back({i, j});
  }
  EXPECT_EQ(MatchByDescriptor(first, second, options), expected);
  EXPECT_GT(expected.size(), 8u);
}

TEST(MatchByDescriptor, DuplicatesAndEmptyLists) {
  std::mt19937_64 rng(11);
  const std::vector<Descriptor> one{RandomDescriptor(rng)};
  const std::vector<Descriptor> twice{one[0], one[0]};
  EXPECT_EQ(MatchByDescriptor(one, one).size(), 1u);
  EXPECT_TRUE(MatchByDescriptor(one, twice).empty());
  const std::vector<Match> expected{{0, 0}};
  EXPECT_EQ(MatchByDescriptor(twice, one), expected);
  EXPECT_TRUE(MatchByDescriptor({}, one).empty());
  EXPECT_TRUE(MatchByDescriptor(one, {}).empty());
}

}  // namespace
}  // namespace vpslam
