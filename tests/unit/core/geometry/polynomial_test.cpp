#include "core/geometry/polynomial.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

std::vector<double> Sorted(const RealRoots& roots) {
  std::vector<double> sorted(roots.begin(), roots.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

/// Coefficients of the product of (x - root), times (x^2 + 1) `pairs` times.
std::vector<double> WithRoots(const std::vector<double>& roots, int pairs) {
  std::vector<double> c = {1};
  const auto multiply = [&c](const std::vector<double>& factor) {
    std::vector<double> product(c.size() + factor.size() - 1, 0.0);
    for (size_t i = 0; i < c.size(); ++i) {
      for (size_t j = 0; j < factor.size(); ++j) product[i + j] += c[i] * factor[j];
    }
    c = product;
  };
  for (const double root : roots) multiply({-root, 1});
  for (int i = 0; i < pairs; ++i) multiply({1, 0, 1});
  return c;
}

TEST(Polynomial, FindsAllSeparateRealRoots) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const int num_roots = 1 + trial % 8;
    std::vector<double> roots;
    // At least 0.2 apart; from within and beyond [-1, 1].
    double root = -2.5;
    for (int i = 0; i < num_roots; ++i) roots.push_back(root += 0.2 + 0.5 * uniform(rng));
    const std::vector<double> c = WithRoots(roots, (trial / 8) % 2);
    const std::vector<double> found =
        Sorted(FindRealRoots(c.data(), static_cast<int>(c.size()) - 1));
    ASSERT_EQ(found.size(), roots.size()) << trial;
    for (size_t i = 0; i < roots.size(); ++i) EXPECT_NEAR(found[i], roots[i], 1e-6);
  }
}

TEST(Polynomial, FindsHugeAndTinyRootsAndThoseAtTheBorders) {
  const std::vector<double> c = WithRoots({-1e6, -1, 1e-5, 1, 300}, 0);
  const std::vector<double> found = Sorted(FindRealRoots(c.data(), 5));
  ASSERT_EQ(found.size(), 5u);
  EXPECT_NEAR(found[0], -1e6, 1e-3);
  EXPECT_NEAR(found[1], -1, 1e-9);
  EXPECT_NEAR(found[2], 1e-5, 1e-12);
  EXPECT_NEAR(found[3], 1, 1e-9);
  EXPECT_NEAR(found[4], 300, 1e-6);
}

TEST(Polynomial, ToleratesVanishingLeadingCoefficientsAndNonsense) {
  const double line[] = {-1, 2, 0, 0};
  const RealRoots roots = FindRealRoots(line, 3);
  ASSERT_EQ(roots.count, 1);
  EXPECT_NEAR(roots.value[0], 0.5, 1e-12);
  const double zero[] = {0, 0, 0};
  EXPECT_EQ(FindRealRoots(zero, 2).count, 0);
  const double none[] = {1, 0, 1};
  EXPECT_EQ(FindRealRoots(none, 2).count, 0);
  const double nan[] = {1, std::nan(""), 1};
  EXPECT_EQ(FindRealRoots(nan, 2).count, 0);
}

}  // namespace
}  // namespace vpslam
