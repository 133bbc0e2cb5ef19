#include "core/geometry/camera.h"

#include <limits>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

Camera Pinhole() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 517.3;
  camera.fy = 516.5;
  camera.cx = 318.6;
  camera.cy = 255.3;
  return camera;
}

Camera Barrel() {
  Camera camera = Pinhole();
  camera.k1 = -0.28;
  camera.k2 = 0.07;
  camera.p1 = 0.0002;
  return camera;
}

Camera Tum1() {
  Camera camera = Pinhole();
  camera.k1 = 0.262383;
  camera.k2 = -0.953104;
  camera.p1 = -0.005358;
  camera.p2 = 0.002628;
  camera.k3 = 1.163314;
  return camera;
}

TEST(Camera, UnprojectInvertsProject) {
  const Camera camera = Pinhole();
  const Eigen::Vector3d x(0.4, -0.3, 2.0);
  EXPECT_NEAR((camera.Unproject(camera.Project(x)) * 2.0 - x).norm(), 0.0, 1e-12);
}

TEST(Camera, UndistortInvertsDistortOverTheWholeImage) {
  for (const Camera& camera : {Pinhole(), Barrel(), Tum1()}) {
    for (int y = 0; y <= camera.height; y += 40) {
      for (int x = 0; x <= camera.width; x += 40) {
        const Eigen::Vector2d distorted(x, y);
        const auto undistorted = camera.Undistort(distorted);
        ASSERT_TRUE(undistorted) << x << " " << y;
        EXPECT_NEAR((camera.Distort(*undistorted) - distorted).norm(), 0.0, 1e-6);
      }
    }
  }
}

TEST(Camera, BarrelDistortionMovesCornersInwards) {
  const Camera camera = Barrel();
  const Camera::Bounds bounds = camera.UndistortedBounds();
  EXPECT_LT(bounds.min_x, -10);
  EXPECT_GT(bounds.max_x, 650);
  EXPECT_FALSE(camera.Undistort({1e5, 1e5}).has_value());
}

TEST(Camera, ValidateNamesTheFault) {
  EXPECT_FALSE(Pinhole().Validate());
  Camera camera = Pinhole();
  camera.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(camera.Validate());
  camera = Pinhole();
  camera.fy = -1;
  EXPECT_TRUE(camera.Validate());
  camera = Pinhole();
  camera.width = 0;
  EXPECT_TRUE(camera.Validate());
  camera = Pinhole();
  camera.cx = 1e6;
  EXPECT_TRUE(camera.Validate());
}

}  // namespace
}  // namespace vpslam
