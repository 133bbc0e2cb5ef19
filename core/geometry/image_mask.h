// Which pixels of an image show the world, and which what moves with the camera: a bonnet, the
// frame of a drone, a hand.
//
// Travels as run lengths: pixels row by row, alternately so many that are seen and so many that are
// hidden, beginning with seen ones (0 if the first pixel is hidden). No runs: everything is seen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vpslam {

/// `hidden` has a value per pixel, row by row; those that are not 0 are hidden. Empty if none is.
std::vector<int32_t> MaskRuns(std::span<const uint8_t> hidden);

class ImageMask {
 public:
  /// Bound of the number of runs, and with it of the message that carries them.
  static constexpr std::size_t kMaxRuns = 65536;

  /// Why these are no runs of an image of this size, or leave nothing to be seen.
  static std::optional<std::string> Fault(std::span<const int32_t> runs, int width, int height);

  /// `runs` without a fault.
  ImageMask(std::span<const int32_t> runs, int width, int height);

  bool HidesAnything() const { return !hidden_.empty(); }
  /// Of the pixel around this position, as the lens sees it; a position outside the image is seen.
  bool Hides(const Eigen::Vector2d& distorted_px) const;
  /// Per pixel, row by row: 1 if hidden. Empty if none is.
  const std::vector<uint8_t>& hidden() const { return hidden_; }
  /// The same view in an image of another size: each pixel is what lies at its centre here.
  std::vector<int32_t> Scaled(int width, int height) const;

 private:
  int width_, height_;
  std::vector<uint8_t> hidden_;
};

/// A segment of which a mask hides parts: its longest part that is seen, without the last `margin`
/// px before a hidden one; nullopt if none is left.
struct SeenPart {
  Eigen::Vector2d start_px, end_px;
};
std::optional<SeenPart> LongestSeenPart(const ImageMask& mask, const Eigen::Vector2d& start_px,
                                        const Eigen::Vector2d& end_px, double margin_px);

}  // namespace vpslam
