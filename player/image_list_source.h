// A source whose images are files that a list names: the part that all data-set layouts share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/decode_image.h"
#include "player/bad_frame_guard.h"
#include "player/image_list.h"
#include "player/image_source.h"

namespace vpslam {

class ImageListSource : public ImageSource {
 public:
  /// Puts the images in order of time, and takes out those that cannot be played. Throws
  /// std::runtime_error if these are too many, or nothing is left.
  ImageListSource(ImageList list, const SourceOptions& options);

  const Camera& camera() const override { return list_.camera; }
  std::optional<SourceFrame> Next() override;
  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override;
  SourceReport Report() override;

 private:
  void TakeTheRange();
  void LookAtThePixels();
  void Skip(const ListedImage& image, const std::string& fault, const std::string& remedy);

  ImageList list_;
  SourceOptions options_;
  size_t next_ = 0;
  int64_t expected_ = 0;  ///< images of the range that --start and --frames ask for
  GreyRange deep_range_;  ///< of images with more than 8 bits
  BadFrameGuard guard_;
};

}  // namespace vpslam
