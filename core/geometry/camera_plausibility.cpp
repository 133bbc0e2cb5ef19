#include "core/geometry/camera_plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <tuple>

namespace vpslam {
namespace {

/// Beyond 147 degrees a pinhole with radial distortion is no model of a lens.
constexpr double kMinFocalPerSize = 0.15;
/// Pixels are squares; those of half a frame of interlaced video are twice as high as wide.
constexpr double kMaxAspect = 2.5;
/// Fits to few pictures fold over in the corners, which does little harm.
constexpr double kMinUsableShare = 0.75;
/// A principal point this near the first pixel, px, is not in px.
constexpr double kCornerPx = 2;

template <class... Args>
std::string Format(const char* format, Args... args) {
  char text[256];
  std::snprintf(text, sizeof text, format, args...);
  return text;
}

}  // namespace

std::optional<std::string> WhyImplausible(const Camera& c) {
  for (const auto& [name, focal_px, size_px] :
       {std::tuple("fx", c.fx, c.width), std::tuple("fy", c.fy, c.height)}) {
    if (focal_px >= kMinFocalPerSize * size_px) continue;
    const double degrees = 2 * std::atan2(0.5 * size_px, focal_px) * 180 / std::numbers::pi;
    return Format(
        "%s is %g for %d px, which is a view of %.0f degrees; it has to be in px, neither in mm "
        "nor "
        "as a share of the image",
        name, focal_px, size_px, degrees);
  }
  const double aspect = std::max(c.fx / c.fy, c.fy / c.fx);
  if (aspect > kMaxAspect) {
    return Format("fx is %g and fy is %g; they differ by a factor of %.1f, and pixels are squares",
                  c.fx, c.fy, aspect);
  }
  if (std::abs(c.cx) < kCornerPx && std::abs(c.cy) < kCornerPx && c.width > 16 * kCornerPx) {
    return Format("cx is %g and cy is %g, the corner of the image; they have to be in px", c.cx,
                  c.cy);
  }
  if (const double usable = UsableShare(c); usable < kMinUsableShare) {
    return Format(
        "its distortion leaves %.0f %% of the image usable; the coefficients are those of another "
        "model or of a bad fit",
        100 * usable);
  }
  return std::nullopt;
}

void RequirePlausible(const Camera& camera, const std::string& name) {
  auto why = camera.Validate();
  if (!why) why = WhyImplausible(camera);
  if (why) throw std::runtime_error(name + ": " + *why + "; correct the calibration");
}

double UsableShare(const Camera& camera) {
  if (!camera.HasDistortion()) return 1;
  constexpr int kColumns = 32, kRows = 24;
  int usable = 0;
  for (int v = 0; v < kRows; ++v) {
    for (int u = 0; u < kColumns; ++u) {
      const Eigen::Vector2d pixel((u + 0.5) * camera.width / kColumns,
                                  (v + 0.5) * camera.height / kRows);
      usable += camera.Undistort(pixel).has_value();
    }
  }
  return static_cast<double>(usable) / (kColumns * kRows);
}

}  // namespace vpslam
