// What the user asks the simulator for: sim:SCENE?key=value&key=value.
#pragma once

#include <cstdint>
#include <string>

namespace vpslam::simulator {

enum class SceneKind { kRoom, kCorridor };

struct Spec {
  SceneKind scene = SceneKind::kRoom;
  uint64_t seed = 1;        ///< of the scene's details, the hand and the noise
  int frames = 600;         ///< at 30 Hz
  double noise = 1;         ///< factor on the image noise
  bool distortion = false;  ///< radial-tangential lens instead of a pinhole
};

/// "sim:room?seed=3&frames=900&noise=0.5&distortion=1"; every key may be left out. Throws
/// std::runtime_error with one line that names the fault and the remedy.
Spec ParseSpec(const std::string& text);

}  // namespace vpslam::simulator
