#include "player/simulator/furniture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "player/simulator/materials.h"
#include "player/simulator/prints.h"

namespace vpslam::simulator {
namespace {

/// Texels for a print of so many metres.
cv::Size Texels(double width_m, double height_m, double texels_per_m) {
  return {std::max(8, static_cast<int>(std::lround(width_m * texels_per_m))),
          std::max(8, static_cast<int>(std::lround(height_m * texels_per_m)))};
}

/// A leaf of a door or drawer with its gap around it, and a bar as handle.
void AddFront(SceneBuilder& builder, const Palette& palette, const Placement& where, double x0,
              double x1, double z0, double z1, double y, bool handle_upright,
              const Surface& surface) {
  constexpr double kGap = 0.004, kThick = 0.018;
  builder.AddBox(where, {x0 + kGap, y - kThick, z0 + kGap}, {x1 - kGap, y, z1 - kGap}, surface);
  const double x = handle_upright ? x1 - 0.05 : (x0 + x1) / 2;
  const double z = handle_upright ? (z0 + z1) / 2 : z1 - 0.05;
  const double half_x = handle_upright ? 0.006 : std::min(0.08, 0.3 * (x1 - x0));
  const double half_z = handle_upright ? std::min(0.09, 0.3 * (z1 - z0)) : 0.006;
  builder.AddBox(where, {x - half_x, y - kThick - 0.03, z - half_z},
                 {x + half_x, y - kThick - 0.018, z + half_z}, palette.metal);
}

}  // namespace

Palette MakePalette(SceneBuilder& builder) {
  Random& random = builder.random();
  Palette p;
  p.wood = builder.Material(Wood(0.36f, random.Next()), 420).Glossy(0.25);
  p.dark_wood = builder.Material(Wood(0.13f, random.Next()), 420).Glossy(0.2);
  p.white_wood = builder.Material(Lacquer(0.68f, random.Next()), 420).Glossy(0.2);
  p.lacquer = builder.Material(Lacquer(0.45f, random.Next()), 420).Glossy(0.3);
  p.dark_lacquer = builder.Material(Lacquer(0.06f, random.Next()), 420).Glossy(0.5);
  p.metal = builder.Material(Lacquer(0.5f, random.Next()), 420).Glossy(0.8);
  p.fabric = builder.Material(Fabric(0.18f, random.Next()), 500);
  p.plastic = builder.Material(Lacquer(0.08f, random.Next()), 420).Glossy(0.3);
  p.door = builder.Material(Wood(0.24f, random.Next()), 380).Glossy(0.15);
  p.frame = builder.Material(Lacquer(0.72f, random.Next()), 420);
  return p;
}

void AddBooks(SceneBuilder& builder, const Placement& where, double x0, double x1, double y_front,
              double z, double height_limit) {
  Random& random = builder.random();
  constexpr double kTexels_per_m = 1100;
  double x = x0 + 0.01;
  while (x < x1 - 0.07) {
    if (random.Chance(0.05)) {
      x += random.Uniform(0.06, 0.16);  // a gap
      continue;
    }
    const double depth = random.Uniform(0.14, 0.21);
    if (random.Chance(0.08) && x < x1 - 0.32) {  // a lying pile
      const int count = 2 + random.Below(4);
      double top = z;
      for (int i = 0; i < count && top < z + height_limit - 0.06; ++i) {
        const double width = random.Uniform(0.2, 0.27), thick = random.Uniform(0.015, 0.04);
        cv::Mat1f spine;
        cv::rotate(Spine(Texels(thick, width, kTexels_per_m), random), spine,
                   cv::ROTATE_90_COUNTERCLOCKWISE);
        const Surface back = builder.Print(spine);
        builder.AddBox(where.Within({x + 0.15, y_front + depth / 2, 0}, random.Uniform(-0.1, 0.1)),
                       {-width / 2, -depth / 2, top}, {width / 2, depth / 2, top + thick},
                       back.Tinted(0.8), {{Face::kFront, back}});
        top += thick;
      }
      x += 0.31;
      continue;
    }
    // Volumes of a series look alike.
    const int volumes = random.Chance(0.12) ? 2 + random.Below(4) : 1;
    const double thick = random.Uniform(0.014, 0.052);
    const double height = std::min(height_limit - 0.02, random.Uniform(0.62, 0.95) * height_limit);
    const Surface spine = builder.Print(Spine(Texels(thick, height, kTexels_per_m), random));
    const double inset = random.Uniform(0, 0.03);
    for (int i = 0; i < volumes && x + thick < x1 - 0.005; ++i) {
      builder.AddBox(where, {x, y_front + inset, z},
                     {x + thick, y_front + inset + depth, z + height}, spine.Tinted(0.75),
                     {{Face::kFront, spine}});
      x += thick + 0.001;
    }
  }
}

void AddBookshelf(SceneBuilder& builder, const Palette& palette, const Placement& where,
                  double width, double height, double depth) {
  constexpr double kBoard = 0.022;
  const double half = width / 2;
  const Surface& wood = palette.wood;
  builder.AddBox(where, {-half, -depth, 0}, {-half + kBoard, 0, height}, wood);
  builder.AddBox(where, {half - kBoard, -depth, 0}, {half, 0, height}, wood);
  builder.AddBox(where, {-kBoard / 2, -depth, 0.08}, {kBoard / 2, 0, height - kBoard}, wood);
  builder.AddQuad(where, {-half, -0.008, height}, {width, 0, 0}, {0, 0, -height}, wood.Tinted(0.8));
  const int shelves = std::max(2, static_cast<int>((height - 0.08) / 0.34));
  const double spacing = (height - kBoard - 0.08) / shelves;
  for (int i = 0; i <= shelves; ++i) {
    const double z = 0.08 + i * spacing;
    builder.AddBox(where, {-half + kBoard, -depth + 0.004, z}, {half - kBoard, 0, z + kBoard},
                   wood);
    if (i == shelves) break;
    for (const double x : {-half + kBoard, kBoard / 2}) {
      AddBooks(builder, where, x, x + half - 1.5 * kBoard, -depth + 0.02, z + kBoard,
               spacing - kBoard);
    }
  }
}

void AddSideboard(SceneBuilder& builder, const Palette& palette, const Placement& where,
                  double width, double height, double depth, int doors) {
  const double half = width / 2;
  builder.AddBox(where, {-half, -depth + 0.06, 0}, {half, 0, 0.09}, palette.plastic);
  builder.AddBox(where, {-half, -depth + 0.02, 0.09}, {half, 0, height - 0.04},
                 palette.dark_lacquer);
  builder.AddBox(where, {-half - 0.01, -depth - 0.02, height - 0.04}, {half + 0.01, 0, height},
                 palette.wood.Glossy(0.5));
  for (int i = 0; i < doors; ++i) {
    const double x0 = -half + width * i / doors, x1 = -half + width * (i + 1) / doors;
    const double drawer = height - 0.04 - 0.18;
    AddFront(builder, palette, where, x0, x1, drawer, height - 0.045, -depth + 0.02, false,
             palette.dark_lacquer);
    AddFront(builder, palette, where, x0, x1, 0.09, drawer, -depth + 0.02, i % 2 == 0,
             palette.dark_lacquer);
  }
}

void AddWardrobe(SceneBuilder& builder, const Palette& palette, const Placement& where,
                 double width, double height, double depth) {
  const double half = width / 2;
  builder.AddBox(where, {-half, -depth, 0}, {half, 0, height}, palette.white_wood.Tinted(0.85));
  AddFront(builder, palette, where, -half, 0, 0.08, height - 0.02, -depth, true,
           palette.white_wood);
  AddFront(builder, palette, where, 0, half, 0.08, height - 0.02, -depth, true, palette.white_wood);
}

void AddTable(SceneBuilder& builder, const Palette& palette, const Placement& where, double width,
              double depth, double height) {
  const double x = width / 2, y = depth / 2;
  // The top is made of three boards of different tone.
  for (int i = 0; i < 3; ++i) {
    constexpr double kTones[] = {0.9, 1.12, 1.0};
    builder.AddBox(where, {-x, -y + depth * i / 3, height - 0.035},
                   {x, -y + depth * (i + 1) / 3, height},
                   palette.wood.Tinted(kTones[i]).Glossy(0.5));
  }
  builder.AddBox(where, {-x + 0.06, -y + 0.06, height - 0.12}, {x - 0.06, y - 0.06, height - 0.036},
                 palette.wood.Tinted(0.8));
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const Eigen::Vector3d foot(sx * (x - 0.07), sy * (y - 0.07), 0);
      builder.AddBox(where, foot - Eigen::Vector3d(0.04, 0.04, 0),
                     foot + Eigen::Vector3d(0.04, 0.04, height - 0.036), palette.wood);
    }
  }
}

void AddChair(SceneBuilder& builder, const Palette& palette, const Placement& where) {
  constexpr double kHalf = 0.21, kSeat = 0.45, kTop = 0.92, kLeg = 0.02;
  const Surface& wood = palette.dark_wood;
  builder.AddBox(where, {-kHalf, -kHalf, kSeat - 0.03}, {kHalf, kHalf, kSeat}, palette.fabric);
  for (const double sx : {-1.0, 1.0}) {
    const double x = sx * (kHalf - kLeg);
    builder.AddBox(where, {x - kLeg, -kHalf, 0}, {x + kLeg, -kHalf + 2 * kLeg, kSeat - 0.03}, wood);
    builder.AddBox(where, {x - kLeg, kHalf - 2 * kLeg, 0}, {x + kLeg, kHalf, kTop}, wood);
  }
  for (int i = 0; i < 4; ++i) {
    const double z = kSeat + 0.1 + 0.1 * i;
    builder.AddBox(where, {-kHalf + 2 * kLeg, kHalf - 0.03, z},
                   {kHalf - 2 * kLeg, kHalf - 0.01, z + (i == 3 ? 0.07 : 0.035)}, wood);
  }
}

void AddDoor(SceneBuilder& builder, const Palette& palette, const Placement& where, double width,
             double height, int number) {
  constexpr double kFrame = 0.08;
  const double half = width / 2;
  builder.AddBox(where, {-half - kFrame, -0.035, 0}, {-half, 0, height + kFrame}, palette.frame);
  builder.AddBox(where, {half, -0.035, 0}, {half + kFrame, 0, height + kFrame}, palette.frame);
  builder.AddBox(where, {-half, -0.035, height}, {half, 0, height + kFrame}, palette.frame);
  builder.AddBox(where, {-half, -0.02, 0.006}, {half, 0, height}, palette.door);
  const double side = builder.random().Chance(0.5) ? 1 : -1;
  const double x = side * (half - 0.07);
  builder.AddBox(where, {x - 0.022, -0.027, 0.92}, {x + 0.022, -0.02, 1.14}, palette.metal);
  const double x_end = x - side * 0.13;
  builder.AddBox(where, {std::min(x, x_end), -0.075, 1.04}, {std::max(x, x_end), -0.058, 1.06},
                 palette.metal);
  builder.AddBox(where, {x - 0.009, -0.075, 1.04}, {x + 0.009, -0.027, 1.06}, palette.metal);
  if (number > 0) {
    const Surface plate =
        builder.Print(DoorPlate(Texels(0.2, 0.12, 900), number, builder.random()));
    const double plate_x = side * (half + kFrame + 0.22);
    builder.AddBox(where, {plate_x - 0.1, -0.012, 1.5}, {plate_x + 0.1, 0, 1.62}, palette.frame,
                   {{Face::kFront, plate}});
  }
}

void AddWindow(SceneBuilder& builder, const Palette& palette, const Placement& where, double width,
               double height, double sill_z, double emission, double radiance) {
  const double half = width / 2, top = sill_z + height;
  constexpr double kFrame = 0.06;
  const Surface view = builder.Print(WindowView(Texels(width, height, 400), builder.random()));
  builder.AddLamp(where, {-half, -0.004, top}, {width, 0, 0}, {0, 0, -height}, view, emission,
                  radiance);
  for (const double x : {-half - kFrame, -kFrame / 2, half}) {
    builder.AddBox(where, {x, -0.05, sill_z - kFrame}, {x + kFrame, 0, top + kFrame},
                   palette.frame);
  }
  for (const double z : {sill_z - kFrame, sill_z + 0.66 * height, top}) {
    for (const double x : {-half, kFrame / 2}) {
      builder.AddBox(where, {x, -0.05, z}, {x + half - kFrame / 2, 0, z + kFrame}, palette.frame);
    }
  }
  builder.AddBox(where, {-half - 0.12, -0.2, sill_z - kFrame - 0.03},
                 {half + 0.12, 0, sill_z - kFrame}, palette.frame);
}

void AddRadiator(SceneBuilder& builder, const Palette& palette, const Placement& where,
                 double width, double height) {
  const int ribs = static_cast<int>(width / 0.07);
  for (int i = 0; i < ribs; ++i) {
    const double x = -width / 2 + i * width / ribs;
    builder.AddBox(where, {x, -0.13, 0.14}, {x + 0.045, -0.04, 0.14 + height}, palette.frame);
  }
  for (const double z : {0.17, 0.11 + height - 0.03}) {
    builder.AddBox(where, {-width / 2, -0.1, z}, {width / 2, -0.06, z + 0.03}, palette.frame);
  }
}

void AddPicture(SceneBuilder& builder, const Surface& frame, const Placement& where, double x,
                double z, double width, double height, double frame_width, const Surface& print) {
  const double half_x = width / 2, half_z = height / 2;
  if (frame_width <= 0) {
    builder.AddBox(where, {x - half_x, -0.004, z - half_z}, {x + half_x, 0, z + half_z}, print);
    return;
  }
  const double f = frame_width;
  builder.AddBox(where, {x - half_x, -0.012, z - half_z}, {x + half_x, 0, z + half_z}, frame,
                 {{Face::kFront, print}});
  for (const double side : {-1.0, 1.0}) {
    const double inner_x = x + side * half_x, outer_x = x + side * (half_x + f);
    builder.AddBox(where, {std::min(inner_x, outer_x), -0.025, z - half_z - f},
                   {std::max(inner_x, outer_x), 0, z + half_z + f}, frame);
    const double inner_z = z + side * half_z, outer_z = z + side * (half_z + f);
    builder.AddBox(where, {x - half_x, -0.025, std::min(inner_z, outer_z)},
                   {x + half_x, 0, std::max(inner_z, outer_z)}, frame);
  }
}

void AddMug(SceneBuilder& builder, const Palette& palette, const Placement& where,
            const Eigen::Vector3d& at) {
  Random& random = builder.random();
  const double radius = random.Uniform(0.036, 0.045), height = random.Uniform(0.085, 0.11);
  const Surface glaze = palette.frame.Tinted(random.Uniform(0.2, 1.15)).Glossy(0.6);
  const Placement mug = where.Within(at, random.Uniform(-3, 3));
  builder.AddPrism(mug, {0, 0, 0}, radius, radius, height, 16, glaze);
  builder.AddBox(mug, {radius, -0.006, 0.2 * height}, {radius + 0.032, 0.006, 0.32 * height},
                 glaze);
  builder.AddBox(mug, {radius, -0.006, 0.75 * height}, {radius + 0.032, 0.006, 0.87 * height},
                 glaze);
  builder.AddBox(mug, {radius + 0.022, -0.006, 0.2 * height},
                 {radius + 0.034, 0.006, 0.87 * height}, glaze);
  const Surface motif = builder.Print(Cover({60, 70}, random));
  builder.AddQuad(mug, {-0.5 * radius, -radius - 0.004, 0.85 * height}, {radius, 0, 0},
                  {0, 0, -0.7 * height}, motif);
}

void AddPlant(SceneBuilder& builder, const Palette& palette, const Placement& where,
              const Eigen::Vector3d& at, double height) {
  Random& random = builder.random();
  const double pot = 0.35 * height;
  builder.AddPrism(where, at, 0.3 * pot, 0.42 * pot, pot, 12, palette.lacquer.Tinted(0.7));
  const Surface leaf = builder.Material(Fabric(0.14f, random.Next()), 600).Glossy(0.3);
  for (int i = 0; i < 60; ++i) {
    const double turn = random.Uniform(0, 6.2832);
    const double lift = random.Uniform(0.25, 1.4);
    const Eigen::Vector3d out(std::cos(turn) * std::cos(lift), std::sin(turn) * std::cos(lift),
                              std::sin(lift));
    const Eigen::Vector3d across(-std::sin(turn), std::cos(turn), random.Uniform(-0.5, 0.5));
    const double length = height * random.Uniform(0.14, 0.3);
    const Eigen::Vector3d root =
        at + Eigen::Vector3d(0, 0, pot) + random.Uniform(0.05, 0.55) * height * out;
    const double width = 0.36 * length;
    builder
        .AddQuad(where, root, length * out + 0.3 * width * across, width * across,
                 leaf.Tinted(random.Uniform(0.6, 1.7)))
        .two_sided = true;
  }
}

void AddParcel(SceneBuilder& builder, const Placement& where, double width, double depth,
               double height) {
  Random& random = builder.random();
  const auto side = [&](double a, double b) {
    return builder.Print(Parcel(Texels(a, b, 450), random));
  };
  const Surface end = side(depth, height), front = side(width, height), top = side(width, depth);
  builder.AddBox(where, {-width / 2, -depth / 2, 0}, {width / 2, depth / 2, height}, end,
                 {{Face::kFront, front}, {Face::kBack, front}, {Face::kTop, top}});
}

}  // namespace vpslam::simulator
