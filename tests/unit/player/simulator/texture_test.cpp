#include "player/simulator/texture.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "player/simulator/materials.h"
#include "player/simulator/noise_image.h"

namespace vpslam::simulator {
namespace {

TEST(Texture, EveryLevelKeepsTheMean) {
  const cv::Mat1f image = 0.5 + 0.4 * WhiteNoise({64, 32}, 3);
  const Texture texture = MakeTexture(image, true);
  ASSERT_EQ(texture.levels.size(), 7u);
  const double mean = cv::mean(image)[0];
  for (const Texture::Level& level : texture.levels) {
    double sum = 0;
    for (int y = 1; y <= level.height; ++y) {
      for (int x = 1; x <= level.width; ++x) sum += level.texels[y * (level.width + 2) + x];
    }
    EXPECT_NEAR(sum / (level.width * level.height), mean, 1e-5);
  }
}

TEST(Texture, BorderWrapsOrRepeats) {
  const cv::Mat1f image = WhiteNoise({8, 4}, 5);
  const Texture::Level wrapped = MakeTexture(image, true).levels[0];
  const Texture::Level clamped = MakeTexture(image, false).levels[0];
  EXPECT_EQ(wrapped.texels[1 * 10 + 0], image(0, 7));
  EXPECT_EQ(wrapped.texels[4 * 10 + 9], image(3, 0));
  EXPECT_EQ(clamped.texels[1 * 10 + 0], image(0, 0));
  EXPECT_EQ(clamped.texels[4 * 10 + 9], image(3, 7));
}

TEST(NoiseImage, IsPeriodicAndSeeded) {
  const cv::Mat1f a = FractalNoise({128, 128}, 4, 4, 3, 0.5, 1);
  // Neighbours across the border differ no more than neighbours elsewhere.
  double inside = 0, across = 0;
  for (int y = 0; y < 128; ++y) {
    inside = std::max<double>(inside, std::abs(a(y, 64) - a(y, 63)));
    across = std::max<double>(across, std::abs(a(y, 0) - a(y, 127)));
  }
  EXPECT_LT(across, 2 * inside);
  EXPECT_EQ(cv::norm(a, FractalNoise({128, 128}, 4, 4, 3, 0.5, 1)), 0);
  EXPECT_GT(cv::norm(a, FractalNoise({128, 128}, 4, 4, 3, 0.5, 2)), 1);
}

TEST(Materials, ReflectancesArePhysical) {
  for (const cv::Mat1f& image :
       {Plaster(0.9f, 1), Wood(0.05f, 1), Parquet(0.3f, 10, 1), Carpet(0.2f, 1), Linoleum(0.3f, 1),
        Fabric(0.2f, 1), Lacquer(0.9f, 1), CeilingBoards(0.7f, 1)}) {
    double low = 0, high = 0;
    cv::minMaxLoc(image, &low, &high);
    EXPECT_GT(low, 0);
    EXPECT_LT(high, 1);
    // Sides are powers of two, as a texture that wraps needs.
    EXPECT_EQ(image.cols & (image.cols - 1), 0);
    EXPECT_EQ(image.rows & (image.rows - 1), 0);
  }
}

}  // namespace
}  // namespace vpslam::simulator
