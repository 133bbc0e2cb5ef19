#include "player/image_list_source.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace vpslam {

ImageListSource::ImageListSource(ImageList list, const SourceOptions& options)
    : list_(std::move(list)), options_(options), guard_(0) {
  if (!list_.images.empty()) {
    PutInOrderOfTime(&list_);
    RequireOneCamera(list_);
    RequireMost(list_);
    LeaveOutMissingFiles(&list_);
  }
  RequireMost(list_);
  if (list_.num_skipped() > 0) {
    options_.tell(fmt::format("{}; {} of {} images are skipped", list_.first_skipped,
                              list_.num_skipped(), list_.total()));
  }
  if (const std::string truth = DescribeTruth(list_); !truth.empty()) list_.notes.push_back(truth);
  TakeTheRange();
  LookAtThePixels();
  for (const std::string& note : list_.notes) options_.tell(note);
}

void ImageListSource::TakeTheRange() {
  const auto n = static_cast<int64_t>(list_.images.size());
  if (options_.start >= n) {
    throw std::runtime_error(
        fmt::format("{}: has {} images, and --start {} leaves none; start earlier", list_.name, n,
                    options_.start));
  }
  next_ = static_cast<size_t>(options_.start);
  expected_ = list_.total() - options_.start;
  if (options_.max_frames > 0) expected_ = std::min(expected_, options_.max_frames);
  if (options_.max_frames > 0 && options_.max_frames < n - options_.start) {
    list_.images.resize(static_cast<size_t>(options_.start + options_.max_frames));
  }
  const auto playable = static_cast<int64_t>(list_.images.size() - next_);
  // Of a part of the list, those that are skipped elsewhere do not matter.
  if (expected_ == playable) list_.skipped.clear();
  guard_ = BadFrameGuard(expected_, {}, std::min(expected_ - playable, list_.num_skipped()));
}

void ImageListSource::LookAtThePixels() {
  constexpr size_t kLooks = 8;
  std::vector<std::string> paths;
  const size_t n = list_.images.size() - next_;
  for (size_t i = 0; i < std::min(n, kLooks); ++i) {
    paths.push_back(list_.images[next_ + i * n / std::min(n, kLooks)].path);
  }
  const DeepPixels deep = LookForDeepPixels(paths);
  if (deep.path.empty()) return;
  deep_range_ = deep.range;
  list_.notes.push_back(fmt::format("{}: has 16-bit pixels; {} to {} are stretched to 0 to 255",
                                    deep.path, deep.range.low, deep.range.high));
}

void ImageListSource::Skip(const ListedImage& image, const std::string& fault,
                           const std::string& remedy) {
  if (const auto why = guard_.CountBad()) {
    throw std::runtime_error(
        fmt::format("{}: {}; {}; {}", list_.Place(image), fault, *why, remedy));
  }
  options_.tell(fmt::format("{}: {}, skipped", list_.Place(image), fault));
}

std::optional<SourceFrame> ImageListSource::Next() {
  while (next_ < list_.images.size()) {
    const ListedImage& image = list_.images[next_++];
    const auto begin = std::chrono::steady_clock::now();
    DecodedImage decoded = DecodeGrey(image.path, deep_range_);
    const double decode_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    if (!decoded.fault.empty()) {
      Skip(image, decoded.fault, fmt::format("correct {} or the image files", list_.name));
      ++list_.skipped[decoded.fault];
      continue;
    }
    const Camera& c = list_.camera;
    if (decoded.grey.cols != c.width || decoded.grey.rows != c.height) {
      Skip(image,
           fmt::format("is {} x {} px but {} says {} x {}", decoded.grey.cols, decoded.grey.rows,
                       list_.camera_name, c.width, c.height),
           "correct the calibration or name another one with --camera");
      ++list_.skipped["is of another size"];
      continue;
    }
    guard_.CountGood();
    return SourceFrame{image.stamp_us, std::move(decoded.grey), decode_ms};
  }
  return std::nullopt;
}

std::optional<SE3> ImageListSource::WorldFromCam(int64_t stamp_us) const {
  const bool moved = list_.bridged_by_us > 0 && stamp_us >= list_.bridged_from_us;
  return list_.truth.Nearest(stamp_us - (moved ? list_.bridged_by_us : 0));
}

SourceReport ImageListSource::Report() {
  SourceReport report;
  report.expected = expected_;
  report.skipped = list_.skipped;
  report.notes = list_.notes;
  return report;
}

}  // namespace vpslam
