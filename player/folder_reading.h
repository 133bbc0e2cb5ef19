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

#include "player/image_list.h"
#include "player/image_source.h"

namespace vpslam {

/// Fills in `image` but for its line, or says what is wrong with the line; `index` counts the
/// lines, see text_lines.h.
using ParseImage =
    std::function<std::string(std::string_view line, int64_t index, ListedImage* image)>;

/// Reads `list->name`. Lines that `parse` refuses count as images that are skipped.
void ReadImageLines(const ParseImage& parse, ImageList* list);

using StampedPose = std::pair<int64_t, SE3>;  ///< us, world_from_cam

/// Fills in `pose`, or says what is wrong with the line.
using ParsePose =
    std::function<std::string(std::string_view line, int64_t index, StampedPose* pose)>;

/// Reads true poses, if there is such a file, and notes it in `list`. Truth is for viewers and
/// tests: what is wrong with it is noted, but stops nothing.
void ReadTruthLines(const std::string& path, const ParsePose& parse, ImageList* list);

/// A line of a list of images, `seconds file`, whose files are in `folder`.
std::string ParseSecondsAndFile(std::string_view line, const std::filesystem::path& folder,
                                ListedImage* image);

/// A line of a true trajectory, `seconds tx ty tz qx qy qz qw`.
std::string ParseTumLine(std::string_view line, int64_t index, StampedPose* pose);

/// `tx ty tz qx qy qz qw` as a pose; nullopt for anything else and for a zero quaternion.
std::optional<SE3> ParseTumPose(std::string_view line);

/// A rotation matrix as it comes out of a text file, with the rounding of its digits; nullopt for
/// what is none.
std::optional<Eigen::Quaterniond> RotationOf(const Eigen::Matrix3d& matrix);

/// The file that the rest of a list's line names, in the first of `folders` where it exists: the
/// whole rest, as names may contain blanks, else its first word, where more columns follow. With
/// the separators of Windows as well. The first folder's if there is none.
std::string ListedFile(std::string_view rest, const std::vector<std::filesystem::path>& folders);

/// True for names that end as those of images do.
bool HasImageEnding(const std::filesystem::path& path);

/// Files whose names end as images do, in natural order: img2 before img10. Folders that cannot be
/// read, or do not exist, hold none.
std::vector<std::filesystem::path> ImageFilesIn(const std::filesystem::path& folder);

/// True if `a` comes before `b`, numbers within names being compared by value.
bool NaturallyBefore(const std::string& a, const std::string& b);

/// Size of the first image that can be read, among those that a good sequence may start with;
/// throws if there is none. For layouts whose calibration does not say it.
cv::Size SizeOfFirstImage(const ImageList& list);

/// The calibration of a layout that has none of its own: --camera, or `camera.yaml` in the folder.
/// Sets camera and camera_name of the list. Throws std::runtime_error.
void ReadListCamera(const std::filesystem::path& folder, const SourceOptions& options,
                    ImageList* list);

}  // namespace vpslam
