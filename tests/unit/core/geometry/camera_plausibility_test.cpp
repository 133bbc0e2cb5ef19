#include "core/geometry/camera_plausibility.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

Camera Vga() {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.fx = c.fy = 520;
  c.cx = 319.5;
  c.cy = 239.5;
  return c;
}

TEST(CameraPlausibility, AcceptsLensesThatExist) {
  EXPECT_EQ(WhyImplausible(Vga()), std::nullopt);
  Camera wide = Vga();  // 130 degrees
  wide.fx = wide.fy = 149;
  EXPECT_EQ(WhyImplausible(wide), std::nullopt);
  Camera far = Vga();
  far.fx = far.fy = 9000;
  EXPECT_EQ(WhyImplausible(far), std::nullopt);
  Camera half_frames = Vga();  // of interlaced video
  half_frames.height = 240;
  half_frames.fy = 260;
  half_frames.cy = 119.5;
  EXPECT_EQ(WhyImplausible(half_frames), std::nullopt);
  Camera cut = Vga();  // a part of an image, beside its middle
  cut.cx = -100;
  EXPECT_EQ(WhyImplausible(cut), std::nullopt);
}

TEST(CameraPlausibility, UsableShareFallsWhereTheModelFolds) {
  Camera c = Vga();
  EXPECT_EQ(UsableShare(c), 1);
  c.k1 = -0.28;
  c.k2 = 0.07;
  EXPECT_EQ(UsableShare(c), 1);
  // x (1 + k1 x^2) has its largest value where x^2 = -1 / (3 k1), and is 2/3 of x there: a circle
  // with a radius of 0.1217 in units of the focal length, 63 px; its area is 4 % of the image.
  c.k1 = -10;
  c.k2 = 0;
  EXPECT_NEAR(UsableShare(c), 0.041, 0.01);
  EXPECT_NE(WhyImplausible(c), std::nullopt);
}

}  // namespace
}  // namespace vpslam
