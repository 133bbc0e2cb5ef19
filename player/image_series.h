// Several series of images that share a folder or a list: colour and depth, left and right, images
// and masks. Played as one, they would make no sense.
#pragma once

#include <string>
#include <vector>

namespace vpslam {

/// Images whose names are the same but for their numbers.
struct ImageSeries {
  std::string pattern;         ///< the common name, with * for numbers: left*.png
  std::vector<size_t> images;  ///< which of the names that were given
  /// True if the name says that these are no pictures of a camera, but depth, masks and the like.
  bool is_companion = false;
};

/// The series that `names` (without folders) consist of, if these run beside each other: most
/// numbers of the one are numbers of the other, too. A single series, or the names as they are,
/// otherwise: then they belong together.
std::vector<ImageSeries> ParallelSeries(const std::vector<std::string>& names);

/// Whether `name` is one of the series with that pattern: * stands for a number.
bool MatchesSeries(const std::string& name, const std::string& pattern);

/// "left*.png (40 images) and right*.png (40 images)"
std::string DescribeSeries(const std::vector<ImageSeries>& series);

}  // namespace vpslam
