#include "frontend/relocalization_gate.h"

#include <gtest/gtest.h>

#include "core/map/depth_quantile.h"
#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

constexpr int64_t kSecond_us = 1'000'000;

class RelocalizationGateTest : public ::testing::Test {
 protected:
  /// Seen for two seconds, thirty times in each, the last time at x = 0 and time 0.
  RelocalizationGate Moving(double speed) {
    RelocalizationGate gate;
    for (int i = -60; i <= 0; ++i) {
      Frame frame = s.TrackedFrame(PoseAt({speed * i / 30, 0, 0}), i);
      s.SetStamp(i * kSecond_us / 30, &frame);
      gate.See(frame);
    }
    return gate;
  }
  bool Allows(const RelocalizationGate& gate, double x, int64_t stamp_us,
              MapId map_id = MapId(0)) const {
    return gate.Allow(s.map.map, map_id, PoseAt({x, 0, 0}), stamp_us);
  }

  TrackingScene s{1, {}};
  const double depth = DepthQuantile(s.map.map, KeyframeId(0), 0.5);
};

TEST_F(RelocalizationGateTest, NeverSeenItMayBeAnywhere) {
  EXPECT_TRUE(Allows(RelocalizationGate(), 1000 * depth, 0));
}

TEST_F(RelocalizationGateTest, AStandingCameraCanStartToMove) {
  const RelocalizationGate gate = Moving(0);
  EXPECT_TRUE(Allows(gate, 0.95 * depth, kSecond_us));
  EXPECT_FALSE(Allows(gate, 1.05 * depth, kSecond_us));
  EXPECT_TRUE(Allows(gate, 1.05 * depth, 2 * kSecond_us));
  EXPECT_FALSE(Allows(gate, 0.05 * depth, kSecond_us / 30)) << "but not within an image";
}

TEST_F(RelocalizationGateTest, AFastCameraComesFarther) {
  const RelocalizationGate gate = Moving(2 * depth);
  for (const double side : {-1, 1}) {
    EXPECT_TRUE(Allows(gate, side * 5.9 * depth, kSecond_us));
    EXPECT_FALSE(Allows(gate, side * 6.1 * depth, kSecond_us));
  }
}

TEST_F(RelocalizationGateTest, OfAnotherMapNothingIsKnown) {
  const RelocalizationGate gate = Moving(0);
  EXPECT_FALSE(Allows(gate, 100 * depth, kSecond_us));
  EXPECT_TRUE(Allows(gate, 100 * depth, kSecond_us, MapId(1)));
}

TEST_F(RelocalizationGateTest, AKeyframeThatIsNotInTheMapYetHidesNothing) {
  RelocalizationGate gate = Moving(0);
  Frame frame = s.TrackedFrame(PoseAt({0, 0, 0}), 1);
  s.SetStamp(kSecond_us / 30, &frame);
  frame.placement.reference = KeyframeId(77);
  gate.See(frame);
  EXPECT_FALSE(Allows(gate, 1.05 * depth, kSecond_us));
  EXPECT_TRUE(Allows(gate, 0.95 * depth, kSecond_us));
}

TEST_F(RelocalizationGateTest, AReturnIsNoMotion) {
  RelocalizationGate gate = Moving(100 * depth);
  gate.Forget();
  EXPECT_TRUE(Allows(gate, 1000 * depth, kSecond_us / 30));
  Frame frame = s.TrackedFrame(PoseAt({0, 0, 0}), 1);
  s.SetStamp(kSecond_us / 30, &frame);
  gate.See(frame);
  EXPECT_FALSE(Allows(gate, 1.05 * depth, kSecond_us));
}

TEST_F(RelocalizationGateTest, TimeThatGoesBackForbidsNothing) {
  EXPECT_TRUE(Allows(Moving(0), 100 * depth, -kSecond_us));
}

TEST_F(RelocalizationGateTest, FollowsCorrectionsOfTheMap) {
  const RelocalizationGate gate = Moving(0);
  const double shift = 50 * depth;
  s.map.map.SetPose(KeyframeId(0), PoseAt({shift, 0, 0}));
  EXPECT_FALSE(Allows(gate, 0, kSecond_us));
  EXPECT_TRUE(Allows(gate, shift, kSecond_us));
}

}  // namespace
}  // namespace vpslam
