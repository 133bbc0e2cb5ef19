// A source whose images are files that a list names: the part that all data-set layouts share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "player/bad_frame_guard.h"
#include "player/image_source.h"
#include "player/truth_track.h"

namespace vpslam {

struct ListedImage {
  int64_t stamp_us = 0;
  std::string path;
};

/// What a layout's reader finds.
struct ImageList {
  std::string name;         ///< the list's file, for messages
  std::string line_form;    ///< what a line of that file looks like, for messages
  std::string camera_name;  ///< the calibration's file, for messages
  Camera camera;
  std::vector<ListedImage> images;
  TruthTrack truth;
};

class ImageListSource : public ImageSource {
 public:
  /// Takes out images whose time stamps are not larger than the one kept before, and tells so.
  /// Throws if nothing is left to play.
  ImageListSource(ImageList list, const SourceOptions& options);

  const Camera& camera() const override { return list_.camera; }
  std::optional<SourceFrame> Next() override;
  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    return list_.truth.Nearest(stamp_us);
  }
  std::string Summary() override;

 private:
  void KeepAscendingStamps();
  void Skip(const ListedImage& image, const std::string& fault, const std::string& remedy);

  ImageList list_;
  SourceOptions options_;
  size_t next_ = 0;
  int64_t repeated_ = 0, backward_ = 0;
  BadFrameGuard guard_;
};

}  // namespace vpslam
