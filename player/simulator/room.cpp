#include <cmath>
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

class RoomBuilder {
 public:
  explicit RoomBuilder(uint64_t seed)
      : builder_(Hash({seed, 0x700a})),
        random_(builder_.random()),
        half_x_(random_.Uniform(2.5, 2.75)),
        half_y_(random_.Uniform(2.15, 2.3)),
        palette_(MakePalette(builder_)) {
    north_ = {{0, half_y_, 0}, 0};
    east_ = {{half_x_, 0, 0}, -kPi / 2};
    south_ = {{0, -half_y_, 0}, kPi};
    west_ = {{-half_x_, 0, 0}, kPi / 2};
  }

  Scene Build() {
    AddShell();
    AddCeilingLamps();
    FurnishNorth();
    FurnishEast();
    FurnishSouth();
    FurnishWest();
    FurnishMiddle();
    builder_.scene().ambient = 0.3;
    return std::move(builder_.scene());
  }

 private:
  Surface Sheet21x30() { return builder_.Print(Sheet({210, 297}, random_)); }
  Surface Magazine() { return builder_.Print(Cover({250, 340}, random_)); }

  void AddShell() {
    const Surface wall = builder_.Material(Plaster(0.62f, random_.Next()), 300);
    const Surface floor = builder_.Material(Parquet(0.30f, 10, random_.Next()), 420).Glossy(0.35);
    const Surface ceiling = builder_.Material(Plaster(0.8f, random_.Next()), 300);
    for (const Placement& side : {north_, east_, south_, west_}) {
      const double half = side.yaw_rad == 0 || side.yaw_rad == kPi ? half_x_ : half_y_;
      builder_.AddQuad(side, {-half, 0, kHeight}, {2 * half, 0, 0}, {0, 0, -kHeight}, wall);
      builder_.AddBox(side, {-half, -0.015, 0}, {half, 0, 0.08}, palette_.frame);
      builder_.AddLine(side, {-half, 0, kHeight}, {half, 0, kHeight}, LineKind::kEdge);
      builder_.AddLine(side, {half, 0, 0}, {half, 0, kHeight}, LineKind::kEdge);
    }
    const Placement middle;
    builder_.AddQuad(middle, {-half_x_, half_y_, 0}, {2 * half_x_, 0, 0}, {0, -2 * half_y_, 0},
                     floor);
    builder_.AddQuad(middle, {-half_x_, -half_y_, kHeight}, {2 * half_x_, 0, 0},
                     {0, 2 * half_y_, 0}, ceiling);
  }

  void AddCeilingLamps() {
    const Surface glass = builder_.Material(Lacquer(0.9f, random_.Next()), 420);
    for (const double x : {-1.2, 1.2}) {
      const Placement middle;
      builder_.AddBox(middle, {x - 0.5, -0.2, kHeight - 0.07}, {x + 0.5, 0.2, kHeight - 0.001},
                      palette_.frame);
      builder_.AddLamp(middle, {x - 0.48, -0.18, kHeight - 0.072}, {0.96, 0, 0}, {0, 0.36, 0},
                       glass, 2.5, 12);
    }
  }

  void FurnishNorth() {
    AddBookshelf(builder_, palette_, north_.Within({-1.45, 0, 0}), 1.7, 2.05, 0.28);
    AddParcel(builder_, north_.Within({-1.9, -0.14, 2.05}, 0.12), 0.36, 0.22, 0.2);
    AddParcel(builder_, north_.Within({-1.2, -0.14, 2.05}, -0.2), 0.28, 0.2, 0.26);

    const Placement kitchen = north_.Within({1.15, 0, 0});
    constexpr double kTop = 0.9;
    AddSideboard(builder_, palette_, kitchen, 2.2, kTop, 0.5, 4);
    const Surface tiles = builder_.Print(WallTiles({1100, 250}, 22, 5, random_));
    builder_.AddBox(kitchen, {-1.1, -0.008, kTop}, {1.1, 0, kTop + 0.5}, tiles);
    AddBooks(builder_, kitchen, -1.0, -0.35, -0.25, kTop, 0.28);
    const Placement leaning = kitchen.Within({0.05, -0.1, kTop});
    builder_.AddBox(leaning, {-0.12, -0.02, 0}, {0.12, 0, 0.33}, Magazine());
    AddPicture(builder_, palette_.dark_wood, kitchen.Within({0.45, -0.06, 0}), 0, kTop + 0.14, 0.3,
               0.22, 0.02, builder_.Print(Painting({240, 180}, random_)));
    AddMug(builder_, palette_, kitchen, {0.3, -0.32, kTop});
    AddMug(builder_, palette_, kitchen, {-0.2, -0.3, kTop});
    AddParcel(builder_, kitchen.Within({0.85, -0.25, kTop}, random_.Uniform(-0.4, 0.4)), 0.26, 0.2,
              0.17);
    builder_.AddLyingSheet(kitchen, {0.55, -0.33, kTop}, 0.21, 0.297, random_.Uniform(-1, 1),
                           Sheet21x30(), palette_.frame);
    // A cupboard on the wall above.
    builder_.AddBox(kitchen, {0.2, -0.32, 1.72}, {1.05, 0, 2.3}, palette_.lacquer);
    builder_.AddBox(kitchen, {0.6, -0.345, 1.74}, {0.615, -0.33, 1.9}, palette_.metal);
    AddPicture(builder_, palette_.frame, kitchen, -0.55, 1.78, 0.55, 0.42, 0.03,
               builder_.Print(Painting({440, 336}, random_)));
  }

  void FurnishEast() {
    AddWindow(builder_, palette_, east_.Within({-0.1, 0, 0}), 1.5, 1.2, 0.95, 1.25, 5);
    AddRadiator(builder_, palette_, east_.Within({-0.1, 0, 0}), 1.3, 0.55);
    AddPlant(builder_, palette_, east_, {0.45, -0.11, 0.86}, 0.42);
    AddPicture(builder_, palette_.frame, east_, -1.4, 1.55, 0.5, 0.7, 0,
               builder_.Print(Poster({400, 560}, random_)));
    AddPicture(builder_, palette_.frame, east_, 1.45, 1.6, 0.42, 0.6, 0,
               builder_.Print(Calendar({340, 480}, random_)));
    AddPlant(builder_, palette_, east_, {1.55, -0.35, 0}, 1.1);
    AddParcel(builder_, east_.Within({-1.5, -0.4, 0}, 0.35), 0.5, 0.36, 0.34);
    AddParcel(builder_, east_.Within({-1.5, -0.4, 0.34}, -0.2), 0.34, 0.28, 0.22);
  }

  void FurnishSouth() {
    AddDoor(builder_, palette_, south_.Within({-1.5, 0, 0}), 0.88, 2.03, 0);
    builder_.AddBox(south_, {-0.86, -0.012, 1.05}, {-0.78, 0, 1.13}, palette_.frame);
    AddPicture(builder_, palette_.wood, south_, 0.1, 1.52, 1.2, 0.85, 0.025,
               builder_.Print(NoticeBoard({900, 640}, random_)));
    AddWardrobe(builder_, palette_, south_.Within({1.75, 0, 0}), 1.1, 1.95, 0.5);
    AddParcel(builder_, south_.Within({1.6, -0.26, 1.95}, 0.2), 0.5, 0.35, 0.25);
    // A low bench with things on it.
    const Placement bench = south_.Within({0.1, -0.2, 0});
    builder_.AddBox(bench, {-0.65, -0.18, 0.4}, {0.65, 0.18, 0.44}, palette_.wood);
    for (const double x : {-0.6, 0.55}) {
      builder_.AddBox(bench, {x, -0.16, 0}, {x + 0.05, 0.16, 0.4}, palette_.dark_wood);
    }
    AddParcel(builder_, bench.Within({-0.3, 0, 0.44}, 0.3), 0.3, 0.22, 0.2);
    builder_.AddLyingSheet(bench, {0.3, 0, 0.44}, 0.22, 0.3, 0.5, Magazine(), palette_.frame);
  }

  void FurnishWest() {
    const Placement desk = west_.Within({0.35, 0, 0});
    constexpr double kTop = 0.74;
    builder_.AddBox(desk, {-0.8, -0.7, kTop - 0.03}, {0.8, 0, kTop}, palette_.white_wood);
    for (const double x : {-0.78, 0.38}) {
      builder_.AddBox(desk, {x, -0.66, 0}, {x + (x < 0 ? 0.04 : 0.4), -0.02, kTop - 0.03},
                      palette_.white_wood.Tinted(0.8));
    }
    for (int i = 0; i < 3; ++i) {
      builder_.AddBox(desk, {0.4, -0.675, 0.05 + 0.22 * i}, {0.76, -0.66, 0.25 + 0.22 * i},
                      palette_.white_wood);
      builder_.AddBox(desk, {0.5, -0.69, 0.19 + 0.22 * i}, {0.66, -0.675, 0.205 + 0.22 * i},
                      palette_.metal);
    }
    const Placement screen = desk.Within({-0.1, -0.3, kTop}, random_.Uniform(-0.25, 0.25));
    builder_.AddBox(screen, {-0.03, 0, 0}, {0.03, 0.04, 0.2}, palette_.plastic);
    builder_.AddBox(screen, {-0.12, -0.08, 0}, {0.12, 0.1, 0.015}, palette_.plastic);
    builder_.AddBox(screen, {-0.29, -0.04, 0.1}, {0.29, 0, 0.47}, palette_.plastic);
    Quad& shining = builder_.AddQuad(screen, {-0.275, -0.041, 0.455}, {0.55, 0, 0}, {0, 0, -0.33},
                                     builder_.Print(Screen({560, 336}, random_)));
    shining.emission = 0.9;
    const Placement keys = desk.Within({-0.1, -0.52, kTop}, random_.Uniform(-0.1, 0.1));
    builder_.AddBox(keys, {-0.22, -0.07, 0}, {0.22, 0.07, 0.018}, palette_.plastic,
                    {{Face::kTop, builder_.Print(Keyboard({440, 140}, random_))}});
    builder_.AddLyingSheet(desk, {0.42, -0.45, kTop}, 0.21, 0.297, 0.3, Sheet21x30(),
                           palette_.frame);
    builder_.AddLyingSheet(desk, {0.58, -0.35, kTop}, 0.21, 0.297, -0.4, Sheet21x30(),
                           palette_.frame);
    AddMug(builder_, palette_, desk, {-0.55, -0.4, kTop});
    AddChair(builder_, palette_, desk.Within({-0.2, -0.95, 0}, kPi + random_.Uniform(-0.6, 0.6)));

    // A board with books and boxes above the desk, and prints beside it.
    builder_.AddBox(desk, {-0.75, -0.24, 1.5}, {0.75, 0, 1.525}, palette_.wood);
    AddBooks(builder_, desk, -0.74, 0.3, -0.22, 1.525, 0.27);
    AddParcel(builder_, desk.Within({0.52, -0.12, 1.525}, 0.15), 0.28, 0.18, 0.2);
    AddPicture(builder_, palette_.frame, west_, -1.2, 1.5, 0.6, 0.85, 0,
               builder_.Print(Poster({480, 680}, random_)));
    AddPicture(builder_, palette_.dark_wood, west_, 1.62, 1.6, 0.5, 0.4, 0.03,
               builder_.Print(Painting({400, 320}, random_)));
    AddPlant(builder_, palette_, west_, {-1.6, -0.35, 0}, 0.9);
    builder_.AddPrism(west_, {-0.75, -0.3, 0}, 0.11, 0.14, 0.32, 16, palette_.plastic);
  }

  void FurnishMiddle() {
    const Placement middle;
    builder_.AddBox(middle, {-1.25, -0.95, 0}, {1.25, 0.95, 0.008}, palette_.fabric,
                    {{Face::kTop, builder_.Print(Rug({900, 684}, random_))}});
    constexpr double kTop = 0.75;
    AddTable(builder_, palette_, middle, 1.5, 0.85, kTop);
    const double around[4][3] = {
        {-0.4, -0.62, kPi}, {0.42, -0.66, kPi}, {-0.38, 0.64, 0}, {0.44, 0.6, 0}};
    for (const auto& [x, y, turn] : around) {
      AddChair(builder_, palette_, middle.Within({x, y, 0.008}, turn + random_.Uniform(-0.3, 0.3)));
    }
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d at(random_.Uniform(-0.6, 0.6), random_.Uniform(-0.25, 0.25),
                               kTop + 0.0022 * i);
      const double turn = random_.Uniform(-kPi, kPi);
      if (i % 2 == 0) {
        builder_.AddLyingSheet(middle, at, 0.21, 0.297, turn, Sheet21x30(), palette_.frame);
      } else {
        builder_.AddLyingSheet(middle, at, 0.22, 0.3, turn, Magazine(), palette_.frame);
      }
    }
    AddMug(builder_, palette_, middle,
           {random_.Uniform(-0.65, -0.5), random_.Uniform(-0.3, 0.3), kTop});
    AddMug(builder_, palette_, middle,
           {random_.Uniform(0.5, 0.65), random_.Uniform(-0.3, 0.3), kTop});
    AddParcel(builder_, middle.Within({0.3, 0.15, kTop + 0.014}, random_.Uniform(0.2, 1.2)), 0.24,
              0.17, 0.11);
  }

  static constexpr double kHeight = 2.6;

  SceneBuilder builder_;
  Random& random_;
  double half_x_, half_y_;
  Palette palette_;
  Placement north_, east_, south_, west_;
};

}  // namespace

Place MakeRoom(uint64_t seed) {
  constexpr int kKnotsPerRound = 12;
  Place place;
  place.scene = RoomBuilder(seed).Build();
  place.knot_s = 1.5;
  Random start(Hash({seed, 0x57a7}));
  const double first_angle = start.Uniform(0, 2 * kPi);
  const double sense = start.Chance(0.5) ? 1 : -1;
  place.waypoint = [seed, first_angle, sense](int k) {
    Random random(Hash({seed, 0x3a7, static_cast<uint64_t>(k + 1000)}));
    const double angle = first_angle + sense * 2 * kPi * k / kKnotsPerRound;
    Waypoint w;
    w.position_m = {(1.45 + random.Uniform(-0.2, 0.2)) * std::cos(angle),
                    (1.15 + random.Uniform(-0.2, 0.2)) * std::sin(angle),
                    1.45 + random.Uniform(-0.2, 0.2)};
    w.yaw_rad = angle + kPi + random.Uniform(-0.45, 0.45);
    w.pitch_rad = -0.27 + random.Uniform(-0.16, 0.16);
    return w;
  };
  return place;
}

}  // namespace vpslam::simulator
