#include "player/icl_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "core/base/camera_file.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 30;

/// The file of true poses; empty if there is none.
fs::path TruthFile(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().ends_with(".gt.freiburg")) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found.empty() ? fs::path() : found.front();
}

/// Images and poses have numbers instead of time stamps.
std::optional<int64_t> StampOfNumber_us(std::string_view word) {
  const auto number = ParseNumber(word);
  if (!number || *number < 0 || *number > 1e9) return std::nullopt;
  return std::llround(*number * 1e6 / kRateHz);
}

constexpr const char* kAssociationForm = "number depth/0.png number rgb/0.png";

/// Of `number depth/0.png number rgb/0.png` the colour image.
std::string ParseAssociation(std::string_view line, const fs::path& folder, ListedImage* image) {
  TakeWord(&line);
  TakeWord(&line);
  const auto stamp_us = StampOfNumber_us(TakeWord(&line));
  const std::string_view file = Trim(line);
  if (!stamp_us || file.empty()) return NotOfTheForm(kAssociationForm);
  image->stamp_us = *stamp_us;
  image->path = ListedFile(file, {folder});
  return {};
}

void ListNumberedImages(const fs::path& images, ImageList* list) {
  for (const fs::path& file : ImageFilesIn(images)) {
    const auto stamp_us = StampOfNumber_us(file.stem().string());
    if (stamp_us) list->images.push_back({*stamp_us, file.string()});
  }
}

}  // namespace

bool IsIclFolder(const std::string& path) {
  std::error_code error;
  return !TruthFile(path).empty() && fs::is_directory(fs::path(path) / "rgb", error);
}

std::unique_ptr<ImageSource> OpenIclFolder(const std::string& path, const SourceOptions& options) {
  const fs::path folder(path);
  std::error_code error;
  ImageList list;
  list.camera_name = "the published calibration of ICL-NUIM";
  list.camera = IclCamera();
  if (!options.camera_file.empty()) {
    list.camera_name = options.camera_file;
    list.camera = ReadCameraFile(options.camera_file);
  }
  list.line_form = kAssociationForm;
  list.unit.clear();
  if (fs::exists(folder / "associations.txt", error)) {
    list.name = (folder / "associations.txt").string();
    ReadImageLines([&](std::string_view line, int64_t /*index*/,
                       ListedImage* image) { return ParseAssociation(line, folder, image); },
                   &list);
  } else {
    list.name = (folder / "rgb").string();
    list.line_form = "rgb/0.png";
    ListNumberedImages(folder / "rgb", &list);
  }
  ReadTruthLines(
      TruthFile(folder).string(),
      [](std::string_view line, int64_t /*index*/, StampedPose* pose) -> std::string {
        const auto stamp_us = StampOfNumber_us(TakeWord(&line));
        const auto read = ParseTumPose(line);
        if (!stamp_us || !read) return NotOfTheForm("number tx ty tz qx qy qz qw");
        *pose = {*stamp_us, ReflectY(*read)};
        return {};
      },
      &list);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

Camera IclCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fps = kRateHz;
  camera.fx = 481.2;
  camera.fy = 480.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

SE3 ReflectY(const SE3& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  // D R(axis, angle) D turns about D axis by -angle.
  return SE3(Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()), {t.x(), -t.y(), t.z()});
}

}  // namespace vpslam
