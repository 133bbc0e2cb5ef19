#include "core/base/thin_out.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(ThinOutStep, VisitsNoMoreThanItIsTold) {
  for (const size_t max_visited : {1, 6, 12}) {
    for (size_t size = 0; size < 100; ++size) {
      const size_t step = ThinOutStep(size, max_visited);
      ASSERT_GE(step, 1u);
      const size_t visited = (size + step - 1) / step;
      EXPECT_LE(visited, max_visited) << size;
      EXPECT_GE(2 * visited, std::min(size, max_visited)) << size;
    }
  }
}

}  // namespace
}  // namespace vpslam
