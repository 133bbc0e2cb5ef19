// Furniture and fittings, built from boxes in the frame that scene_builder.h describes.
#pragma once

#include "player/simulator/scene_builder.h"

namespace vpslam::simulator {

/// Surfaces that the things of one place share.
struct Palette {
  Surface wood, dark_wood, white_wood;  ///< 400 texels a metre
  Surface lacquer, dark_lacquer, metal;
  Surface fabric, plastic;
  Surface door, frame;
};

Palette MakePalette(SceneBuilder& builder);

/// Books standing side by side from x0 to x1 on z, backs at y_front, with gaps and lying piles.
void AddBooks(SceneBuilder& builder, const Placement& where, double x0, double x1, double y_front,
              double z, double height_limit);
/// Against the wall, centred at x = 0 of `where`.
void AddBookshelf(SceneBuilder& builder, const Palette& palette, const Placement& where,
                  double width, double height, double depth);
/// Low cupboards with doors, drawers, handles and a worktop; things to put on it are up to the
/// caller. The top's surface is at z = height.
void AddSideboard(SceneBuilder& builder, const Palette& palette, const Placement& where,
                  double width, double height, double depth, int doors);
void AddWardrobe(SceneBuilder& builder, const Palette& palette, const Placement& where,
                 double width, double height, double depth);
/// Free-standing, centre at the origin.
void AddTable(SceneBuilder& builder, const Palette& palette, const Placement& where, double width,
              double depth, double height);
/// Free-standing; the back rest is at y > 0.
void AddChair(SceneBuilder& builder, const Palette& palette, const Placement& where);
/// In the wall at x = 0; the leaf is 0.02 m in front of it. `number` > 0 adds a plate beside it.
void AddDoor(SceneBuilder& builder, const Palette& palette, const Placement& where, double width,
             double height, int number);
/// A window with frame, cross and sill, lighting the room with `radiance`.
void AddWindow(SceneBuilder& builder, const Palette& palette, const Placement& where, double width,
               double height, double sill_z, double emission, double radiance);
void AddRadiator(SceneBuilder& builder, const Palette& palette, const Placement& where,
                 double width, double height);
/// A print of width x height, centre at (x, z) of the wall; frame_width 0: a bare sheet.
void AddPicture(SceneBuilder& builder, const Surface& frame, const Placement& where, double x,
                double z, double width, double height, double frame_width, const Surface& print);
/// Centre of the foot at `at`.
void AddMug(SceneBuilder& builder, const Palette& palette, const Placement& where,
            const Eigen::Vector3d& at);
void AddPlant(SceneBuilder& builder, const Palette& palette, const Placement& where,
              const Eigen::Vector3d& at, double height);
/// A closed cardboard box; `where` is the centre of its foot.
void AddParcel(SceneBuilder& builder, const Placement& where, double width, double depth,
               double height);

}  // namespace vpslam::simulator
