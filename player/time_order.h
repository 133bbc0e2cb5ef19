// Images in order of time, where the time stamps of a file are not.
//
// A list may be shuffled, sorted by name, or newest first: it is sorted. A few stamps may be wrong:
// their images are set aside. A clock may be set back while a sequence is recorded: what follows is
// moved behind what was before. To tell these apart, what is looked at is the step from one image
// to the next, which sorting restores where lines were only mixed up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vpslam {

struct TimeOrder {
  /// By time: which image comes when. Stamps ascend strictly; they differ from those of the file
  /// behind a jump of the clock only.
  std::vector<size_t> order;
  std::vector<int64_t> stamps_us;

  std::vector<size_t> repeated;   ///< images with the stamp of another one, which is kept
  std::vector<size_t> set_aside;  ///< images whose stamps fit nowhere
  bool sorted = false;            ///< by time: the file had another order

  /// Where the clock was set back, and by how much the images from there on are moved, at least as
  /// much as time went back; 0 if it was not.
  size_t jump_at = 0;
  int64_t jump_us = 0;

  /// How often, where it was more than once: the images cannot be brought in any order then, and
  /// jump_at is the first time.
  int clocks = 1;
};

/// `stamps_us`: of the images in the order of the file.
TimeOrder OrderByTime(std::span<const int64_t> stamps_us);

/// The median of the steps between stamps that ascend, us; 0 for fewer than two.
int64_t MedianStep_us(std::span<const int64_t> ascending_us);

}  // namespace vpslam
