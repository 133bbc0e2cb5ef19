#include "core/map/line_view.h"

#include <gtest/gtest.h>

#include "tests/unit/test_camera.h"

namespace vpslam {
namespace {

std::optional<ImageSegment> Predict(const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                                    const SE3& cam_from_world = SE3(), double min_length_px = 20) {
  const Camera camera = TestCamera();
  MapLine line;
  line.start = start;
  line.end = end;
  return PredictSegment(line, cam_from_world, camera, camera.UndistortedBounds(), min_length_px);
}

void ExpectSegment(const std::optional<ImageSegment>& s, const Eigen::Vector2d& start_px,
                   const Eigen::Vector2d& end_px) {
  ASSERT_TRUE(s);
  EXPECT_NEAR((s->start_px - start_px).norm(), 0, 1e-9);
  EXPECT_NEAR((s->end_px - end_px).norm(), 0, 1e-9);
}

TEST(PredictSegment, IsTheImageOfTheEnds) {
  ExpectSegment(Predict({-1, 0.5, 5}, {1, 1, 10}), {220, 288}, {370, 288});
  ExpectSegment(Predict({1, 1, 10}, {-1, 0.5, 5}), {370, 288}, {220, 288});
  const SE3 pose(ExpSo3({0.1, -0.2, 0.05}), Eigen::Vector3d(0.1, 0.2, -0.3));
  const Eigen::Vector3d a(-0.5, 0, 5), b(0.7, 0.5, 6);
  ExpectSegment(Predict(a, b, pose), TestCamera().Project(pose * a),
                TestCamera().Project(pose * b));
}

TEST(PredictSegment, IsCutAtTheImagesBorder) {
  const auto bounds = TestCamera().UndistortedBounds();
  ExpectSegment(Predict({-10, 0, 5}, {0, 0, 5}), {bounds.min_x, 240}, {320, 240});
  ExpectSegment(Predict({0, 0, 5}, {10, 0, 5}), {320, 240}, {bounds.max_x, 240});
  ExpectSegment(Predict({0, 9, 5}, {0, -9, 5}), {320, bounds.max_y}, {320, bounds.min_y});
  // Through a corner of the image plane, but not through the image.
  EXPECT_FALSE(Predict({-9, 0, 5}, {0, -9, 5}));
  EXPECT_FALSE(Predict({-10, 0, 5}, {-8, 0, 5}));
  EXPECT_FALSE(Predict({0, 10, 5}, {0, 8, 5}));
}

TEST(PredictSegment, BehindTheCameraNothingIsSeen) {
  EXPECT_FALSE(Predict({-1, 0, -5}, {1, 0, -5}));
  EXPECT_FALSE(Predict({-1, 0, 0}, {1, 0, 0}));
}

TEST(PredictSegment, ALineThatPassesTheCameraIsSeenBeforeIt) {
  // It runs along the ground, from far ahead to behind the camera: downwards in the image.
  const auto s = Predict({0.2, 1, 20}, {0.2, 1, -20});
  ASSERT_TRUE(s);
  EXPECT_NEAR((s->start_px - Eigen::Vector2d(325, 264)).norm(), 0, 1e-9);
  EXPECT_NEAR(s->end_px.y(), TestCamera().UndistortedBounds().max_y, 1e-9);
  EXPECT_NEAR((s->end_px.x() - 320) / (s->end_px.y() - 240), 0.2 * 500 / 480, 1e-9);
  const auto reversed = Predict({0.2, 1, -20}, {0.2, 1, 20});
  ASSERT_TRUE(reversed);
  EXPECT_NEAR((reversed->start_px - s->end_px).norm(), 0, 1e-9);
  EXPECT_NEAR((reversed->end_px - s->start_px).norm(), 0, 1e-9);
}

TEST(PredictSegment, WhatIsLeftMustBeLongEnough) {
  EXPECT_TRUE(Predict({0, 0, 5}, {0.21, 0, 5}));
  EXPECT_FALSE(Predict({0, 0, 5}, {0.19, 0, 5}));
  EXPECT_TRUE(Predict({0, 0, 5}, {0.19, 0, 5}, SE3(), 15));
  EXPECT_FALSE(Predict({0, 0, 5}, {0, 0, 50})) << "along the optical axis";
}

}  // namespace
}  // namespace vpslam
