#include "core/features/rotation_consistency.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

constexpr float kTwoPi = 2 * std::numbers::pi_v<float>;

TEST(RotationConsistency, KeepsTheMajorityAndDropsTheRest) {
  std::mt19937 rng(1);
  std::normal_distribution<float> noise(0.f, 0.03f);
  std::uniform_real_distribution<float> any(0.f, kTwoPi);
  for (const float turn : {0.0f, 0.4f, 3.1f, 6.2f}) {
    std::vector<float> differences;
    for (int i = 0; i < 300; ++i) {
      // As it comes from subtracting two angles in [0, 2 pi): in (-2 pi, 2 pi).
      differences.push_back(i % 3 ? turn + noise(rng) - (i % 2 ? kTwoPi : 0.f) : any(rng));
    }
    const std::vector<uint8_t> kept = FindRotationConsistent(differences);
    int right = 0, wrong = 0;
    for (int i = 0; i < 300; ++i) (i % 3 ? right : wrong) += kept[i];
    EXPECT_GE(right, 195);  // of 200
    EXPECT_LE(wrong, 25);   // of 100: 3 of 30 bins hold 10 of them
  }
}

TEST(RotationConsistency, SparseBinsBesideTheHighestAreDropped) {
  std::vector<float> differences(50, 0.0f);
  differences.push_back(2.0f);
  differences.push_back(4.0f);
  const std::vector<uint8_t> kept = FindRotationConsistent(differences);
  EXPECT_TRUE(kept[0]);
  EXPECT_FALSE(kept[50]);
  EXPECT_FALSE(kept[51]);
}

TEST(RotationConsistency, EmptyAndSingle) {
  EXPECT_TRUE(FindRotationConsistent({}).empty());
  EXPECT_EQ(FindRotationConsistent(std::vector<float>{-5.0f}), std::vector<uint8_t>{1});
}

TEST(RotationConsistency, ValidateNamesTheFault) {
  EXPECT_FALSE(RotationConsistencyOptions().Validate());
  EXPECT_TRUE(RotationConsistencyOptions{.num_bins = 0}.Validate());
  EXPECT_TRUE(RotationConsistencyOptions{.keep_bins = 0}.Validate());
  EXPECT_TRUE(RotationConsistencyOptions{.min_share = 2}.Validate());
}

}  // namespace
}  // namespace vpslam
