// Writes a simulated sequence as a folder in the layout of the TUM RGB-D benchmark, for runs in
// real time and for other systems. Beside rgb/, rgb.txt, groundtruth.txt and camera.yaml:
//   lines3d.txt    a line `ax ay az bx by bz kind axis` per segment of the scene, m, world; kind is
//                  `edge` or `mark` (drawn on a surface), axis the Manhattan direction 0 to 2 it
//                  runs along, or -1
//   manhattan.txt  `world` and the three orthogonal directions x y z each, unit norm, sign free
#pragma once

#include <filesystem>
#include <functional>

#include "player/simulator/simulator.h"

namespace vpslam {

/// `folder` is created; it must not hold anything yet. `progress` is called after each frame with
/// the number of frames written. Throws std::runtime_error with one line naming file, fault and
/// remedy.
void RenderToFolder(simulator::Simulator& simulator, const std::filesystem::path& folder,
                    const std::function<void(int)>& progress);

}  // namespace vpslam
