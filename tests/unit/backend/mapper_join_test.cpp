// Two maps of one scene that become one: what happens to them at the seam.
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/backend/ideal_frontend.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

/// Map 0 of the first half of the way and map 1 of the second, whose vanishing points say that it
/// is askew by so much. Its last keyframe looks back at where map 0 ends.
class MapperJoinTest : public ::testing::Test {
 protected:
  void Walk(double askew_deg) {
    frontend_.axes = axes_;
    frontend_.Start(OnTheWay(0), OnTheWay(2));
    for (int i = 3; i < 12; ++i) frontend_.Add(OnTheWay(i));
    frontend_.axes = ExpSo3({0, askew_deg * kRadPerDeg, 0}) * axes_;
    frontend_.Start(OnTheWay(23), OnTheWay(21));
    for (int i = 20; i > 12; --i) frontend_.Add(OnTheWay(i));
    frontend_.Add(OnTheWay(12), MapId(0));
  }
  /// How far what the end of map 1 shows lies from the axes of the map that it is in.
  double Askew_deg(MapId map) const {
    const KeyframeId id(frontend_.replica.Find(KeyframeId(kFirstOfMap1)) ? kFirstOfMap1
                                                                         : kFirstOfMap1 + 1);
    const Eigen::Quaterniond shown =
        frontend_.views.at(id).cam_from_world.rotation * *frontend_.axes;
    return AngleBetween_rad(frontend_.replica.Find(id)->cam_from_world.rotation *
                                frontend_.replica.ManhattanFrames(map).front().world_from_manhattan,
                            shown) /
           kRadPerDeg;
  }

  static constexpr int kFirstOfMap1 = 11;
  const Eigen::Quaterniond axes_ = ExpSo3({0.3, -0.5, 0.2});
  IdealFrontend frontend_{1, {.num_points = 1200, .length = 14}};
};

TEST_F(MapperJoinTest, TwoMapsBecomeOneWithOneSetOfAxes) {
  Walk(0);
  EXPECT_EQ(frontend_.replica.Maps(), std::vector<MapId>{MapId(0)});
  EXPECT_LT(Askew_deg(MapId(0)), 0.5);
}

TEST_F(MapperJoinTest, AskewByLittleTheyAreStillOnePlace) {
  Walk(5);
  EXPECT_EQ(frontend_.replica.Maps(), std::vector<MapId>{MapId(0)});
  EXPECT_EQ(frontend_.replica.ManhattanFrames(MapId(0)).size(), 1u);
}

TEST_F(MapperJoinTest, AskewByMuchTheyStayApart) {
  Walk(12);
  EXPECT_EQ(frontend_.replica.Maps(), (std::vector<MapId>{MapId(0), MapId(1)}));
  EXPECT_LT(Askew_deg(MapId(1)), 0.5);
}

}  // namespace
}  // namespace vpslam
