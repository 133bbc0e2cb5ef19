// What the readers of data-set folders share: lists of images and true poses, line by line.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "player/image_list_source.h"

namespace vpslam {

/// Reads `list->name`. A few lines that `parse` refuses are told and skipped, as BadFrameOptions
/// allow it of images; more throw std::runtime_error. `list->line_form` describes a good one.
void ReadImageLines(const SourceOptions& options,
                    const std::function<std::optional<ListedImage>(std::string_view)>& parse,
                    ImageList* list);

using StampedPose = std::pair<int64_t, SE3>;  ///< us, world_from_cam

/// Reads true poses, if there is such a file. Truth is for viewers and tests: what is wrong with it
/// is told, but stops nothing.
void ReadTruthLines(const SourceOptions& options, const std::string& path, const std::string& form,
                    const std::function<std::optional<StampedPose>(std::string_view)>& parse,
                    TruthTrack* truth);

inline constexpr const char* kTumPoseForm = "seconds tx ty tz qx qy qz qw";

/// `tx ty tz qx qy qz qw` as a pose; nullopt for anything else and for a zero quaternion.
std::optional<SE3> ParseTumPose(std::string_view line);

/// Files whose names end as images do, in natural order: img2 before img10. Folders that cannot be
/// read, or do not exist, hold none.
std::vector<std::filesystem::path> ImageFilesIn(const std::filesystem::path& folder);

/// True if `a` comes before `b`, numbers within names being compared by value.
bool NaturallyBefore(const std::string& a, const std::string& b);

/// Size of the first image that can be read, among those that a good sequence may start with;
/// throws if there is none. For layouts whose calibration does not say it.
cv::Size SizeOfFirstImage(const ImageList& list);

}  // namespace vpslam
