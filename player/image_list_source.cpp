#include "player/image_list_source.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/base/decode_image.h"

namespace vpslam {

ImageListSource::ImageListSource(ImageList list, const SourceOptions& options)
    : list_(std::move(list)), options_(options), guard_(0) {
  if (list_.images.empty()) {
    throw std::runtime_error(list_.name + ": lists no image; write lines of the form '" +
                             list_.line_form + "'");
  }
  KeepAscendingStamps();
  const auto n = static_cast<int64_t>(list_.images.size());
  if (options_.start >= n) {
    throw std::runtime_error(
        fmt::format("{}: has {} images, and --start {} leaves none; start earlier", list_.name, n,
                    options_.start));
  }
  next_ = static_cast<size_t>(options_.start);
  if (options_.max_frames > 0 && options_.max_frames < n - options_.start) {
    list_.images.resize(static_cast<size_t>(options_.start + options_.max_frames));
  }
  guard_ = BadFrameGuard(static_cast<int64_t>(list_.images.size() - next_));
}

void ImageListSource::KeepAscendingStamps() {
  std::vector<ListedImage> kept;
  kept.reserve(list_.images.size());
  const auto tell_once = [&](const ListedImage& image, const char* what, int64_t* count) {
    if (++*count > 1) return;
    options_.tell(fmt::format("{}: {} has a {} time stamp, skipped; any further ones are counted",
                              list_.name, image.path, what));
  };
  for (ListedImage& image : list_.images) {
    if (kept.empty() || image.stamp_us > kept.back().stamp_us) {
      kept.push_back(std::move(image));
    } else if (image.stamp_us == kept.back().stamp_us) {
      tell_once(image, "repeated", &repeated_);
    } else {
      tell_once(image, "backward", &backward_);
    }
  }
  list_.images = std::move(kept);
}

void ImageListSource::Skip(const ListedImage& image, const std::string& fault,
                           const std::string& remedy) {
  if (const auto why = guard_.CountBad()) {
    throw std::runtime_error(fmt::format("{}: {}; {}; {}", image.path, fault, *why, remedy));
  }
  options_.tell(fmt::format("{}: {}, skipped", image.path, fault));
}

std::optional<SourceFrame> ImageListSource::Next() {
  while (next_ < list_.images.size()) {
    const ListedImage& image = list_.images[next_++];
    const auto begin = std::chrono::steady_clock::now();
    DecodedImage decoded = DecodeGrey(image.path);
    const double decode_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    if (!decoded.fault.empty()) {
      Skip(image, decoded.fault, fmt::format("correct {} or the image files", list_.name));
      continue;
    }
    const Camera& c = list_.camera;
    if (decoded.grey.cols != c.width || decoded.grey.rows != c.height) {
      Skip(image,
           fmt::format("is {} x {} px but {} says {} x {}", decoded.grey.cols, decoded.grey.rows,
                       list_.camera_name, c.width, c.height),
           "correct the calibration or name another one with --camera");
      continue;
    }
    guard_.CountGood();
    return SourceFrame{image.stamp_us, std::move(decoded.grey), decode_ms};
  }
  return std::nullopt;
}

std::string ImageListSource::Summary() {
  if (repeated_ + backward_ + guard_.bad() == 0) return {};
  return fmt::format(
      "{}: skipped {} bad images, {} repeated and {} backward time stamps; played {} images",
      list_.name, guard_.bad(), repeated_, backward_, guard_.good());
}

}  // namespace vpslam
