#include "player/time_order.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace vpslam {
namespace {

/// So many images may be out of place before it is said that the whole list is: 5 %.
constexpr size_t kFewPercent = 5;
/// Runs of ascending stamps this long, on the average, are those of a clock; shuffling leaves 2.
constexpr size_t kLongRun = 4;
/// In units of the usual step: what is less is between images of two clocks...
constexpr double kShortStep = 0.75;
/// ...here an image is missing...
constexpr double kHole = 1.5;
/// ...and so far may an image be behind the last one.
constexpr double kLargestStep = 5;

size_t Few(size_t n) { return std::max<size_t>(1, n * kFewPercent / 100); }

int64_t Median(std::vector<int64_t> steps) {
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Positions in `stamps` of a longest ascending subsequence.
std::vector<size_t> LongestAscent(const std::vector<int64_t>& stamps) {
  constexpr size_t kNone = std::numeric_limits<size_t>::max();
  std::vector<size_t> ends;  // by length: where the ascent with the smallest end stops
  std::vector<size_t> before(stamps.size(), kNone);
  for (size_t i = 0; i < stamps.size(); ++i) {
    const auto place =
        std::lower_bound(ends.begin(), ends.end(), stamps[i],
                         [&](size_t end, int64_t stamp) { return stamps[end] < stamp; });
    if (place != ends.begin()) before[i] = *std::prev(place);
    if (place == ends.end()) {
      ends.push_back(i);
    } else {
      *place = i;
    }
  }
  std::vector<size_t> ascent;
  for (size_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i]) {
    ascent.push_back(i);
  }
  std::reverse(ascent.begin(), ascent.end());
  return ascent;
}

/// Works on the images without those that have the stamp of the one before.
class Orderer {
 public:
  explicit Orderer(std::span<const int64_t> stamps_us) {
    for (size_t i = 0; i < stamps_us.size(); ++i) {
      if (!stamps_.empty() && stamps_us[i] == stamps_.back()) {
        result_.repeated.push_back(i);
        continue;
      }
      image_.push_back(i);
      stamps_.push_back(stamps_us[i]);
    }
  }

  TimeOrder Run() {
    std::vector<size_t> all(stamps_.size());
    std::iota(all.begin(), all.end(), 0);
    if (std::is_sorted(stamps_.begin(), stamps_.end())) return Take(all);
    const std::vector<size_t> ascent = LongestAscent(stamps_);
    if (stamps_.size() - ascent.size() <= Few(stamps_.size())) return PlaceTheFew(ascent);
    if (!Bridge()) {
      Sort(&all);
    }
    return Take(all);
  }

 private:
  TimeOrder Take(const std::vector<size_t>& places) {
    for (const size_t place : places) {
      const bool moved = result_.jump_us > 0 && image_[place] >= result_.jump_at;
      result_.order.push_back(image_[place]);
      result_.stamps_us.push_back(stamps_[place] + (moved ? result_.jump_us : 0));
    }
    return std::move(result_);
  }

  void Sort(std::vector<size_t>* places) {
    result_.sorted = true;
    std::stable_sort(places->begin(), places->end(),
                     [&](size_t a, size_t b) { return stamps_[a] < stamps_[b]; });
    std::vector<size_t> kept;
    for (const size_t place : *places) {
      if (kept.empty() || stamps_[kept.back()] != stamps_[place]) {
        kept.push_back(place);
      } else {
        result_.repeated.push_back(image_[place]);
      }
    }
    *places = std::move(kept);
    std::sort(result_.repeated.begin(), result_.repeated.end());
  }

  /// Those that are not in `ascent` go where they are missed, or nowhere.
  TimeOrder PlaceTheFew(const std::vector<size_t>& ascent) {
    std::vector<bool> kept(stamps_.size(), false);
    std::vector<size_t> places = ascent, strays;
    std::vector<int64_t> ascending;
    for (const size_t place : ascent) {
      kept[place] = true;
      ascending.push_back(stamps_[place]);
    }
    for (size_t i = 0; i < stamps_.size(); ++i) {
      if (!kept[i]) strays.push_back(i);
    }
    const auto step = static_cast<double>(MedianStep_us(ascending));
    const auto earlier = [&](size_t a, size_t b) { return stamps_[a] < stamps_[b]; };
    std::sort(strays.begin(), strays.end(), earlier);
    for (const size_t stray : strays) {
      const auto next = std::lower_bound(places.begin(), places.end(), stray, earlier);
      if (IsMissed(places, next, stamps_[stray], step)) {
        places.insert(next, stray);
        result_.sorted = true;
      } else {
        result_.set_aside.push_back(image_[stray]);
      }
    }
    std::sort(result_.set_aside.begin(), result_.set_aside.end());
    return Take(places);
  }

  bool IsMissed(const std::vector<size_t>& places, std::vector<size_t>::const_iterator next,
                int64_t stamp, double step) const {
    const auto distance = [&](size_t place) {
      return static_cast<double>(std::abs(stamps_[place] - stamp));
    };
    if (next == places.end()) return distance(*std::prev(next)) <= kLargestStep * step;
    if (next == places.begin()) return distance(*next) <= kLargestStep * step;
    return distance(*std::prev(next)) + distance(*next) >= kHole * step;
  }

  /// True if the clock was set back; says so in the result.
  bool Bridge() {
    std::vector<size_t> run_of(stamps_.size(), 0), begins = {0};
    std::vector<int64_t> steps;
    for (size_t i = 1; i < stamps_.size(); ++i) {
      if (stamps_[i] < stamps_[i - 1]) {
        begins.push_back(i);
      } else {
        steps.push_back(stamps_[i] - stamps_[i - 1]);
      }
      run_of[i] = begins.size() - 1;
    }
    if (stamps_.size() < kLongRun * begins.size()) return false;
    const int64_t step = Median(std::move(steps));
    const bool mixed =
        ShortStepsBetweenRuns(run_of, step) > Few(stamps_.size()) && !IsEvenWhenSorted();
    const size_t second = begins[1];
    const bool apart = begins.size() == 2 && stamps_.back() < stamps_.front() &&
                       static_cast<double>(stamps_.front() - stamps_.back()) >
                           kLargestStep * static_cast<double>(step);
    if (!mixed && !apart) return false;
    result_.jump_at = image_[second];
    if (begins.size() > 2) {
      result_.clocks = static_cast<int>(begins.size());
      return true;
    }
    result_.jump_us = stamps_[second - 1] + step - stamps_[second];
    return true;
  }

  /// Whether sorting restores the rhythm of a camera, as of a list that has every second image
  /// first.
  bool IsEvenWhenSorted() const {
    std::vector<int64_t> sorted = stamps_;
    std::sort(sorted.begin(), sorted.end());
    const auto usual = static_cast<double>(MedianStep_us(sorted));
    size_t odd = 0;
    for (size_t i = 1; i < sorted.size(); ++i) {
      const auto step = static_cast<double>(sorted[i] - sorted[i - 1]);
      odd += step < 0.6 * usual || step > 1.4 * usual;
    }
    return odd <= Few(sorted.size());
  }

  /// Where sorting would put images of two runs closer together than a camera takes them.
  size_t ShortStepsBetweenRuns(const std::vector<size_t>& run_of, int64_t step) const {
    std::vector<size_t> sorted(stamps_.size());
    std::iota(sorted.begin(), sorted.end(), 0);
    std::sort(sorted.begin(), sorted.end(),
              [&](size_t a, size_t b) { return stamps_[a] < stamps_[b]; });
    size_t count = 0;
    for (size_t i = 1; i < sorted.size(); ++i) {
      const auto gap = static_cast<double>(stamps_[sorted[i]] - stamps_[sorted[i - 1]]);
      count += run_of[sorted[i]] != run_of[sorted[i - 1]] &&
               gap < kShortStep * static_cast<double>(step);
    }
    return count;
  }

  TimeOrder result_;
  std::vector<size_t> image_;    // by place: its index in the file
  std::vector<int64_t> stamps_;  // by place
};

}  // namespace

TimeOrder OrderByTime(std::span<const int64_t> stamps_us) { return Orderer(stamps_us).Run(); }

int64_t MedianStep_us(std::span<const int64_t> ascending_us) {
  std::vector<int64_t> steps;
  for (size_t i = 1; i < ascending_us.size(); ++i) {
    steps.push_back(ascending_us[i] - ascending_us[i - 1]);
  }
  return Median(std::move(steps));
}

}  // namespace vpslam
