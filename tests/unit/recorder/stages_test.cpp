#include "recorder/stages.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(Quantile, InterpolatesBetweenFiniteValues) {
  EXPECT_EQ(Quantile({}, 0.5), std::nullopt);
  EXPECT_EQ(Quantile({kNotRun, kNotRun}, 0.5), std::nullopt);
  EXPECT_DOUBLE_EQ(*Quantile({7, kNotRun}, 0.95), 7);
  EXPECT_DOUBLE_EQ(*Quantile({4, 1, kNotRun, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(*Quantile({4, 1, 3, 2}, 0), 1);
  EXPECT_DOUBLE_EQ(*Quantile({4, 1, 3, 2}, 1), 4);
  EXPECT_NEAR(*Quantile({10, 20, 30, 40, 50}, 0.95), 48, 1e-12);
}

}  // namespace
}  // namespace vpslam
