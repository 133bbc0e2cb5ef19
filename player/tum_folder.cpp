#include "player/tum_folder.h"

#include <filesystem>
#include <utility>

#include "core/base/camera_file.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

std::optional<ListedImage> ParseImageLine(std::string_view line, const fs::path& folder) {
  const auto stamp_us = ParseStamp_us(TakeWord(&line));
  const std::string_view file = Trim(line);  // the rest of the line: names may contain blanks
  if (!stamp_us || file.empty()) return std::nullopt;
  return ListedImage{*stamp_us, (folder / file).string()};
}

std::optional<StampedPose> ParsePoseLine(std::string_view line) {
  const auto stamp_us = ParseStamp_us(TakeWord(&line));
  const auto pose = ParseTumPose(line);
  if (!stamp_us || !pose) return std::nullopt;
  return StampedPose(*stamp_us, *pose);
}

}  // namespace

bool IsTumFolder(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(fs::path(path) / "rgb.txt", error);
}

std::unique_ptr<ImageSource> OpenTumFolder(const std::string& path, const SourceOptions& options) {
  const fs::path folder(path);
  ImageList list;
  list.name = (folder / "rgb.txt").string();
  list.line_form = "seconds file";
  list.camera_name =
      options.camera_file.empty() ? (folder / "camera.yaml").string() : options.camera_file;
  list.camera = ReadCameraFile(list.camera_name);
  ReadImageLines(
      options, [&](std::string_view line) { return ParseImageLine(line, folder); }, &list);
  ReadTruthLines(options, (folder / "groundtruth.txt").string(), kTumPoseForm, ParsePoseLine,
                 &list.truth);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
