#include <cmath>
#include <initializer_list>
#include <iterator>
#include <numbers>
#include <utility>

#include "player/simulator/furniture.h"
#include "player/simulator/materials.h"
#include "player/simulator/place.h"
#include "player/simulator/prints.h"
#include "player/simulator/scene_builder.h"

namespace vpslam::simulator {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalfWidth = 0.95;
constexpr double kHeight = 2.5;
constexpr double kStart = -2.0;  // x of the wall behind the first position
constexpr double kOuter = 9.0;   // x of the wall that ends the first leg
constexpr double kInner = kOuter - 2 * kHalfWidth;
constexpr double kEnd = 9.0;       // y of the wall that ends the second leg
constexpr double kBoard_m = 0.62;  // side of a ceiling board
constexpr double kPace_m_s = 0.75;
constexpr double kKnot_s = 0.6;

class CorridorBuilder {
 public:
  explicit CorridorBuilder(uint64_t seed)
      : builder_(Hash({seed, 0xc0441d04})),
        random_(builder_.random()),
        palette_(MakePalette(builder_)),
        wall_(builder_.Material(Plaster(0.58f, random_.Next()), 300)),
        skirting_(palette_.dark_wood.Tinted(1.3)),
        number_(101 + random_.Below(60)) {
    palette_.door = palette_.door.Tinted(0.7);
  }

  Scene Build() {
    AddFloorAndCeiling();
    // Walls from left to right as one faces them; doors at distances from the left end.
    AddWall({kOuter, -kHalfWidth}, {kStart, -kHalfWidth}, {2.6, 5.3, 8.6});
    AddWall({kStart, kHalfWidth}, {kInner, kHalfWidth}, {1.4, 4.5, 7.3});
    AddWall({kStart, -kHalfWidth}, {kStart, kHalfWidth}, {0.95});
    AddWall({kOuter, kEnd}, {kOuter, -kHalfWidth}, {2.3, 5.2, 8.95});
    AddWall({kInner, kHalfWidth}, {kInner, kEnd}, {1.9, 5.6});
    AddWall({kInner, kEnd}, {kOuter, kEnd}, {});
    AddFittings();
    builder_.scene().ambient = 0.26;
    return std::move(builder_.scene());
  }

 private:
  static Placement Facing(const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
    return {{left.x(), left.y(), 0}, std::atan2(right.y() - left.y(), right.x() - left.x())};
  }

  void AddWall(const Eigen::Vector2d& left, const Eigen::Vector2d& right,
               std::initializer_list<double> doors) {
    const Placement wall = Facing(left, right);
    const double length = (right - left).norm();
    builder_.AddQuad(wall, {0, 0, kHeight}, {length, 0, 0}, {0, 0, -kHeight}, wall_);
    builder_.AddLine(wall, {0, 0, kHeight}, {length, 0, kHeight}, LineKind::kEdge);
    builder_.AddLine(wall, {length, 0, 0}, {length, 0, kHeight}, LineKind::kEdge);
    builder_.AddBox(wall, {0, -0.014, 0}, {length, 0, 0.11}, skirting_);
    // A rail that keeps trolleys off the wall; the leaves of the doors stand before it.
    if (doors.size() > 1) {
      builder_.AddBox(wall, {0, -0.018, 0.84}, {length, 0, 0.98}, skirting_.Tinted(1.2));
    }
    for (const double x : doors) {
      const double at = x + random_.Uniform(-0.12, 0.12);
      AddDoor(builder_, palette_, wall.Within({at, 0, 0}), 0.92, 2.05, number_++);
    }
  }

  void AddFloorAndCeiling() {
    const Surface floor = builder_.Material(Linoleum(0.26f, random_.Next()), 300).Glossy(0.3);
    const Surface board = builder_.Material(CeilingBoards(0.72f, random_.Next()), 256 / kBoard_m);
    const Placement middle;
    const double legs[2][4] = {{kStart, -kHalfWidth, kOuter, kHalfWidth},
                               {kInner, kHalfWidth, kOuter, kEnd}};
    for (const auto& [x0, y0, x1, y1] : legs) {
      builder_.AddQuad(middle, {x0, y1, 0}, {x1 - x0, 0, 0}, {0, y0 - y1, 0}, floor);
      // Boards begin in the corner; the bars between them are lines drawn on the ceiling.
      builder_.AddQuad(middle, {x0, y0, kHeight}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}, board)
          .texel_offset = {0, 0};
      // The texture of the leg along y is turned and begins at its far side in x.
      const bool turned = y1 - y0 > x1 - x0;
      for (double d = kBoard_m; d < x1 - x0; d += kBoard_m) {
        const double x = turned ? x1 - d : x0 + d;
        builder_.AddLine(middle, {x, y0, kHeight}, {x, y1, kHeight}, LineKind::kMark);
      }
      for (double d = kBoard_m; d < y1 - y0; d += kBoard_m) {
        builder_.AddLine(middle, {x0, y0 + d, kHeight}, {x1, y0 + d, kHeight}, LineKind::kMark);
      }
    }
    const Surface glass = builder_.Material(Lacquer(0.9f, random_.Next()), 420);
    for (double x = kStart + 1.2; x < kOuter; x += 2.45) AddLamp({x, 0}, true, glass);
    for (double y = kHalfWidth + 1.6; y < kEnd; y += 2.45) {
      AddLamp({kOuter - kHalfWidth, y}, false, glass);
    }
  }

  void AddLamp(const Eigen::Vector2d& at, bool along_x, const Surface& glass) {
    const Placement lamp{{at.x(), at.y(), 0}, along_x ? 0 : kPi / 2};
    builder_.AddBox(lamp, {-0.6, -0.16, kHeight - 0.03}, {0.6, 0.16, kHeight - 0.001},
                    palette_.frame);
    builder_.AddLamp(lamp, {-0.58, -0.14, kHeight - 0.031}, {1.16, 0, 0}, {0, 0.28, 0}, glass, 2.5,
                     11);
  }

  void AddFittings() {
    const Placement end = Facing({kInner, kEnd}, {kOuter, kEnd}).Within({kHalfWidth, 0, 0});
    AddWindow(builder_, palette_, end, 1.0, 1.2, 0.95, 1.25, 3);
    const Placement left = Facing({kStart, kHalfWidth}, {kInner, kHalfWidth});
    AddPicture(builder_, palette_.wood, left.Within({2.95, 0, 0}), 0, 1.5, 0.9, 0.65, 0.025,
               builder_.Print(NoticeBoard({720, 520}, random_)));
    const Placement right = Facing({kOuter, -kHalfWidth}, {kStart, -kHalfWidth});
    builder_.AddPrism(right, {3.95, -0.12, 0.35}, 0.075, 0.075, 0.5, 16,
                      palette_.lacquer.Tinted(0.35));
    AddPicture(builder_, palette_.frame, right, 3.95, 1.25, 0.2, 0.2, 0,
               builder_.Print(Cover({160, 160}, random_)));
    for (const double x : {1.7, 6.4}) {
      builder_.AddBox(right, {x, -0.012, 1.05}, {x + 0.085, 0, 1.2}, palette_.frame);
    }
    // A bench in the second leg, and a poster over it.
    const Placement inner = Facing({kInner, kHalfWidth}, {kInner, kEnd});
    builder_.AddBox(inner, {3.1, -0.42, 0.42}, {4.4, -0.04, 0.46}, palette_.wood);
    for (const double x : {3.2, 4.2}) {
      builder_.AddBox(inner, {x, -0.38, 0}, {x + 0.06, -0.08, 0.42}, palette_.plastic);
    }
    AddPicture(builder_, palette_.metal, inner, 3.75, 1.55, 0.5, 0.7, 0.015,
               builder_.Print(Poster({400, 560}, random_)));
  }

  SceneBuilder builder_;
  Random& random_;
  Palette palette_;
  Surface wall_, skirting_;
  int number_;
};

/// Where the walk is after so many metres: out along both legs, a turn on the spot, and back.
struct Station {
  double walked_m, x, y, yaw_rad;
};

constexpr double kCentre = kOuter - kHalfWidth;  // x of the second leg's middle
constexpr double kFar = kEnd - 1.5;
constexpr double kLeg1 = kCentre;  // the walk starts at x = 0
constexpr double kLeg2 = kFar;
constexpr double kTurn_m = 2.4;  // the time of a turn on the spot, as if one walked on
constexpr Station kWalk[] = {
    {0, 0, 0, 0},
    {kLeg1 - 1.3, kCentre - 1.3, 0, 0},
    {kLeg1 - 0.15, kCentre - 0.15, 0, kPi / 4},
    {kLeg1 + 1.3, kCentre, 1.3, kPi / 2},
    {kLeg1 + kLeg2, kCentre, kFar, kPi / 2},
    {kLeg1 + kLeg2 + kTurn_m, kCentre, kFar - 0.4, 1.5 * kPi},
    {kLeg1 + 2 * kLeg2 + kTurn_m - 1.7, kCentre, 1.3, 1.5 * kPi},
    {kLeg1 + 2 * kLeg2 + kTurn_m - 0.25, kCentre - 0.15, 0, 1.25 * kPi},
    {kLeg1 + 2 * kLeg2 + kTurn_m + 0.9, kCentre - 1.3, 0, kPi},
    {2 * kLeg1 + 2 * kLeg2 + kTurn_m - 0.8, 0.4, 0, kPi},
    {2 * kLeg1 + 2 * kLeg2 + 2 * kTurn_m - 0.8, 0, 0, 0},
};
constexpr double kRound_m = kWalk[std::size(kWalk) - 1].walked_m;

Station At(double walked_m) {
  const double rounds = std::floor(walked_m / kRound_m);
  const double rest = walked_m - rounds * kRound_m;
  size_t i = 1;
  while (i + 1 < std::size(kWalk) && kWalk[i].walked_m < rest) ++i;
  const Station &a = kWalk[i - 1], &b = kWalk[i];
  const double f = (rest - a.walked_m) / (b.walked_m - a.walked_m);
  return {walked_m, a.x + f * (b.x - a.x), a.y + f * (b.y - a.y),
          a.yaw_rad + f * (b.yaw_rad - a.yaw_rad)};
}

}  // namespace

Place MakeCorridor(uint64_t seed) {
  Place place;
  place.scene = CorridorBuilder(seed).Build();
  place.knot_s = kKnot_s;
  place.exposure_s = 0.012;
  place.waypoint = [seed](int k) {
    Random random(Hash({seed, 0x3a1c, static_cast<uint64_t>(k + 1000)}));
    const Station s = At(kPace_m_s * kKnot_s * k);
    Waypoint w;
    w.position_m = {s.x + random.Uniform(-0.12, 0.12), s.y + random.Uniform(-0.12, 0.12),
                    1.5 + random.Uniform(-0.06, 0.06)};
    w.yaw_rad = s.yaw_rad + random.Uniform(-0.16, 0.16);
    w.pitch_rad = -0.05 + random.Uniform(-0.08, 0.08);
    return w;
  };
  return place;
}

}  // namespace vpslam::simulator
