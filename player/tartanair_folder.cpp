#include "player/tartanair_folder.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 10;
constexpr std::string_view kCameras[] = {"left", "lcam_front"};

/// Name of the camera whose images are there; empty if there is none.
std::string CameraIn(const fs::path& folder) {
  std::error_code error;
  for (const std::string_view camera : kCameras) {
    if (fs::is_directory(folder / ("image_" + std::string(camera)), error)) {
      return std::string(camera);
    }
  }
  return {};
}

SE3 NedFromCam() {
  Eigen::Matrix3d m;
  m << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return SE3(Eigen::Quaterniond(m), Eigen::Vector3d::Zero());
}

}  // namespace

bool IsTartanAirFolder(const std::string& path) {
  const std::string camera = CameraIn(path);
  std::error_code error;
  return !camera.empty() &&
         fs::is_regular_file(fs::path(path) / ("pose_" + camera + ".txt"), error);
}

std::unique_ptr<ImageSource> OpenTartanAirFolder(const std::string& path,
                                                 const SourceOptions& options) {
  const fs::path folder(path);
  const std::string name = CameraIn(folder);
  if (name.empty()) {
    throw std::runtime_error(path + ": holds neither image_left/ nor image_lcam_front/");
  }
  ImageList list;
  list.name = (folder / ("image_" + name)).string();
  list.line_form = "000000_" + name + ".png";
  list.unit.clear();
  double rate_hz = options.fps > 0 ? options.fps : kRateHz;
  if (!options.camera_file.empty()) {
    ReadListCamera(folder, options, &list);
    if (options.fps <= 0) rate_hz = list.camera.fps;
  }
  for (const fs::path& file : ImageFilesIn(list.name)) {
    const auto i = static_cast<double>(list.images.size());
    list.images.push_back({std::llround(i * 1e6 / rate_hz), file.string()});
  }
  if (options.camera_file.empty()) {
    list.camera_name = "the published calibration of TartanAir";
    const cv::Size size = SizeOfFirstImage(list);
    list.camera.width = size.width;
    list.camera.height = size.height;
    list.camera.fx = list.camera.fy = list.camera.cx = size.width / 2.0;
    list.camera.cy = size.height / 2.0;
  }
  list.camera.fps = rate_hz;

  ReadTruthLines((folder / ("pose_" + name + ".txt")).string(),
                 [&](std::string_view line, int64_t index, StampedPose* pose) -> std::string {
                   const auto i = static_cast<size_t>(index);
                   const auto ned = ParseTumPose(line);
                   if (CountWords(line) != 7 || !ned) return NotOfTheForm("tx ty tz qx qy qz qw");
                   if (i >= list.images.size()) return "has no image of its number";
                   *pose = {list.images[i].stamp_us, *ned * NedFromCam()};
                   return {};
                 },
                 &list);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
