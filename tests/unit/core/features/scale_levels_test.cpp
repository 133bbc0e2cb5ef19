#include "core/features/scale_levels.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(ScalePyramid, ScalesAreAGeometricSeries) {
  const ScalePyramid scales(8, 1.2);
  EXPECT_EQ(scales.num_levels(), 8);
  EXPECT_DOUBLE_EQ(scales.scale(0), 1.0);
  EXPECT_NEAR(scales.scale(7), std::pow(1.2, 7), 1e-12);
  EXPECT_NEAR(scales.sigma2(3), std::pow(1.2, 6), 1e-12);
}

TEST(ScalePyramid, PredictOctaveInvertsMaxDistance) {
  const ScalePyramid scales(8, 1.2);
  for (int octave = 0; octave < 8; ++octave) {
    for (const double distance : {0.3, 2.0, 70.0}) {
      const double max_distance = scales.MaxDistance(distance, octave);
      EXPECT_EQ(scales.PredictOctave(distance, max_distance), octave);
      EXPECT_EQ(scales.PredictOctave(distance * 1.05, max_distance), octave);
      EXPECT_EQ(scales.PredictOctave(distance * 0.95, max_distance), octave);
    }
  }
}

TEST(ScalePyramid, TwiceAsFarIsAFinerLevel) {
  const ScalePyramid scales(8, 1.2);
  const double max_distance = scales.MaxDistance(1.0, 6);
  EXPECT_EQ(scales.PredictOctave(2.0, max_distance), 2);  // log 2 / log 1.2 = 3.8
}

TEST(ScalePyramid, PredictOctaveStaysInThePyramid) {
  const ScalePyramid scales(8, 1.2);
  EXPECT_EQ(scales.PredictOctave(1000.0, 1.0), 0);
  EXPECT_EQ(scales.PredictOctave(1e-6, 1.0), 7);
  EXPECT_EQ(scales.PredictOctave(0.0, 1.0), 7);
  EXPECT_NEAR(scales.MinDistance(scales.MaxDistance(3.0, 7)), 3.0, 1e-12);
}

}  // namespace
}  // namespace vpslam
