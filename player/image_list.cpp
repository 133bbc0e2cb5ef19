#include "player/image_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "player/bad_frame_guard.h"
#include "player/image_series.h"
#include "player/time_order.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

/// Cameras of this rate exist; a list of more images per second has another unit.
constexpr double kMaxRateHz = 1000;
/// Rates differ by so much from what a calibration says, at most, before the unit is in doubt.
constexpr double kMaxRateRatio = 20;
/// A step that is 1000 times too long or short by this factor is one of another unit.
constexpr double kUnitSlack = 4;

double Seconds(int64_t us) { return 1e-6 * static_cast<double>(us); }

std::vector<int64_t> StampsOf(const std::vector<ListedImage>& images) {
  std::vector<int64_t> stamps;
  stamps.reserve(images.size());
  for (const ListedImage& image : images) stamps.push_back(image.stamp_us);
  return stamps;
}

/// The unit whose steps are `ratio` times as short as those of `unit`; empty if there is none.
std::string UnitOfRatio(const std::string& unit, double ratio) {
  constexpr std::array<const char*, 4> kUnits = {"nanoseconds", "microseconds", "milliseconds",
                                                 "seconds"};
  const auto of = std::find(kUnits.begin(), kUnits.end(), unit);
  if (of == kUnits.end()) return {};
  const double thousands = std::log10(ratio) / 3;
  const double steps = std::round(thousands);
  if (std::abs(thousands - steps) * 3 > std::log10(kUnitSlack)) return {};
  const auto index = (of - kUnits.begin()) - static_cast<std::ptrdiff_t>(steps);
  if (steps == 0 || index < 0 || index >= static_cast<std::ptrdiff_t>(kUnits.size())) return {};
  return kUnits[static_cast<size_t>(index)];
}

/// 0, 1, 2, ... in the list's own unit, and not since 1970.
bool AreNumbersOfImages(const std::vector<int64_t>& stamps, double unit_us) {
  const auto unit = static_cast<int64_t>(unit_us);
  size_t ones = 0;
  for (size_t i = 1; i < stamps.size(); ++i) ones += stamps[i] - stamps[i - 1] == unit;
  constexpr int64_t kMostImages = 10'000'000;
  return 10 * ones >= 9 * (stamps.size() - 1) && stamps.back() < kMostImages * unit &&
         stamps.front() >= 0;
}

std::string FaultOfTimes(const ImageList& list) {
  const std::vector<int64_t> stamps = StampsOf(list.images);
  if (list.unit.empty() || stamps.size() < 4) return {};
  const double step_s = Seconds(MedianStep_us(stamps));
  const double rate_hz = list.rate_hz > 0 ? list.rate_hz : list.camera.fps;
  const double ratio = step_s * rate_hz;
  const bool is_usual = ratio <= kMaxRateRatio && ratio >= 1 / kMaxRateRatio;
  if (is_usual) return {};
  if (list.unit == "seconds" && AreNumbersOfImages(stamps, list.unit_us)) {
    return fmt::format(
        "are numbers of images, not {}; write times, or `fps: {:g}` into the calibration if the "
        "images were taken that slowly",
        list.unit, 1 / step_s);
  }
  if (const std::string unit = UnitOfRatio(list.unit, ratio); !unit.empty()) {
    return fmt::format(
        "are {}, where {} are meant: they are {:g} s apart, and {} has {:g} Hz; write {}, or the "
        "true `fps` into the calibration",
        unit, list.unit, step_s, list.rate_hz > 0 ? "the data set" : list.camera_name, rate_hz,
        list.unit);
  }
  if (1 / step_s > kMaxRateHz) {
    return fmt::format("are {:g} s apart, which makes {:g} images a second; write {}", step_s,
                       1 / step_s, list.unit);
  }
  return {};
}

/// Gaps of the clock, or of the recording; for a list in order of time.
void NoteGaps(ImageList* list) {
  constexpr double kLongGap_s = 60;
  int gaps = 0;
  size_t longest = 0;
  double longest_s = kLongGap_s;
  for (size_t i = 1; i < list->images.size(); ++i) {
    const double gap_s = Seconds(list->images[i].stamp_us - list->images[i - 1].stamp_us);
    gaps += gap_s > kLongGap_s;
    if (gap_s > longest_s) {
      longest_s = gap_s;
      longest = i;
    }
  }
  if (gaps == 0) return;
  list->notes.push_back(fmt::format("{}: comes {:.0f} s after the image before{}",
                                    list->Place(list->images[longest]), longest_s,
                                    gaps > 1 ? fmt::format(", the longest of {} gaps", gaps) : ""));
}

/// Of a list whose time stamps repeat: why they do.
std::string WhyRepeated(const ImageList& list) {
  const bool whole = std::all_of(list.images.begin(), list.images.end(),
                                 [](const auto& image) { return image.stamp_us % 1'000'000 == 0; });
  return whole ? "; they look rounded: write them with all their decimals" : "";
}

}  // namespace

int64_t ImageList::num_skipped() const {
  int64_t sum = 0;
  for (const auto& [reason, count] : skipped) sum += count;
  return sum;
}

void ImageList::Skip(const std::string& reason, const std::string& what) {
  ++skipped[reason];
  if (first_skipped.empty()) first_skipped = what;
}

std::string ImageList::Place(const ListedImage& image) const {
  return image.line > 0 ? fmt::format("{}:{}: {}", name, image.line, image.path) : image.path;
}

void PutInOrderOfTime(ImageList* list) {
  std::vector<ListedImage>& images = list->images;
  const TimeOrder time = OrderByTime(StampsOf(images));
  if (time.clocks > 1) {
    throw std::runtime_error(fmt::format(
        "{}: time goes back here, and {} times in all: these are the stamps of several clocks or "
        "cameras; write each into a list of its own",
        list->Place(images[time.jump_at]), time.clocks - 1));
  }
  for (const size_t i : time.repeated) {
    list->Skip("repeated time stamp", fmt::format("{} has the time stamp {:.6f} of another image{}",
                                                  list->Place(images[i]),
                                                  Seconds(images[i].stamp_us), WhyRepeated(*list)));
  }
  for (const size_t i : time.set_aside) {
    list->Skip("time stamp out of place",
               fmt::format("{} has the time stamp {:.6f}, which fits nowhere in the list",
                           list->Place(images[i]), Seconds(images[i].stamp_us)));
  }
  if (time.sorted) list->notes.push_back(list->name + ": is not in order of time, and was sorted");
  if (time.jump_us > 0) {
    const size_t at = time.jump_at;
    const double back_s = Seconds(images[at - 1].stamp_us - images[at].stamp_us);
    list->bridged_from_us = images[at].stamp_us + time.jump_us;
    list->bridged_by_us = time.jump_us;
    list->notes.push_back(
        fmt::format("{}: the clock was set back by {:g} s here; the images from here on were moved "
                    "behind those "
                    "before",
                    list->Place(images[at]), back_s));
  }
  std::vector<ListedImage> ordered;
  ordered.reserve(time.order.size());
  for (size_t i = 0; i < time.order.size(); ++i) {
    ordered.push_back(std::move(images[time.order[i]]));
    ordered.back().stamp_us = time.stamps_us[i];
  }
  images = std::move(ordered);
  NoteGaps(list);
}

void LeaveOutMissingFiles(ImageList* list) {
  std::vector<ListedImage> there;
  there.reserve(list->images.size());
  for (ListedImage& image : list->images) {
    std::error_code error;
    if (fs::exists(image.path, error)) {
      there.push_back(std::move(image));
    } else {
      list->Skip("is missing", list->Place(image) + ": is missing");
    }
  }
  list->images = std::move(there);
}

void RequireOneCamera(const ImageList& list) {
  std::vector<std::string> names;
  for (const ListedImage& image : list.images) {
    names.push_back(fs::path(image.path).filename().string());
  }
  if (const auto series = ParallelSeries(names); series.size() > 1) {
    throw std::runtime_error(list.name + ": lists the images of several cameras or kinds as one: " +
                             DescribeSeries(series) + "; write each into a list of its own");
  }
  if (const std::string fault = FaultOfTimes(list); !fault.empty()) {
    const ListedImage& second = list.images[1];
    throw std::runtime_error(fmt::format(
        "{}: the time stamps {}",
        second.line > 0 ? fmt::format("{}:{}", list.name, second.line) : list.name, fault));
  }
}

void RequireMost(const ImageList& list) {
  if (list.total() == 0) {
    throw std::runtime_error(list.name + ": lists no image; write lines of the form '" +
                             list.line_form + "'");
  }
  const int64_t skipped = list.num_skipped();
  const BadFrameGuard guard(list.total());
  if (list.images.empty() || guard.IsTooMany(skipped)) {
    throw std::runtime_error(fmt::format("{}; {} of {} images cannot be played; correct {}",
                                         list.first_skipped, skipped, list.total(), list.name));
  }
}

std::string DescribeTruth(const ImageList& list) {
  if (list.truth_name.empty()) return {};
  const auto n = static_cast<int64_t>(list.images.size());
  int64_t found = 0;
  for (const ListedImage& image : list.images) {
    const bool moved = list.bridged_by_us > 0 && image.stamp_us >= list.bridged_from_us;
    found += list.truth.Nearest(image.stamp_us - (moved ? list.bridged_by_us : 0)) ? 1 : 0;
  }
  if (static_cast<double>(found) >= 0.95 * static_cast<double>(n)) return {};
  std::string line =
      fmt::format("{}: has true poses for {} of {} images", list.truth_name, found, n);
  if (list.truth.size() == 0) return line;
  if (found > 0) return line;
  const double first_s = Seconds(list.images.front().stamp_us);
  const double last_s = Seconds(list.images.back().stamp_us);
  line +=
      fmt::format(": its times are {:.3f} to {:.3f} s, those of the images {:.3f} to {:.3f} s",
                  Seconds(list.truth.first_us()), Seconds(list.truth.last_us()), first_s, last_s);
  const double ratio = Seconds(list.truth.last_us()) / last_s;
  for (const auto& [factor, unit] :
       {std::pair(1e3, "milliseconds"), std::pair(1e6, "microseconds")}) {
    if (last_s > 0 && ratio > 0.5 * factor && ratio < 2 * factor) {
      line += fmt::format(", so they may be {}", unit);
    }
  }
  return line;
}

}  // namespace vpslam
