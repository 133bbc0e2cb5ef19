#include "player/eth3d_folder.h"

#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/geometry/camera_plausibility.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"
#include "player/tum_folder.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

std::array<double, 4> ReadIntrinsics(const std::string& path) {
  std::optional<std::array<double, 4>> found;
  ReadLines(path, [&](std::string_view line, const LinePlace&) -> std::string {
    const size_t words = CountWords(line);
    const auto numbers = TakeNumbers<4>(&line);
    if (words != 4 || !numbers || found) return NotOfTheForm("fx fy cx cy");
    found = numbers;
    return {};
  });
  if (!found) {
    throw std::runtime_error(path +
                             ": holds no line 'fx fy cx cy'; take the file of the benchmark, or "
                             "name a calibration with --camera");
  }
  return *found;
}

}  // namespace

bool IsEth3dFolder(const std::string& path) {
  std::error_code error;
  const fs::path folder(path);
  return IsTumFolder(path) && fs::is_regular_file(folder / "calibration.txt", error) &&
         !fs::exists(folder / "camera.yaml", error);
}

std::unique_ptr<ImageSource> OpenEth3dFolder(const std::string& path,
                                             const SourceOptions& options) {
  const fs::path folder(path);
  ImageList list;
  ReadTumLists(folder, &list);
  if (!options.camera_file.empty()) {
    ReadListCamera(folder, options, &list);
    return std::make_unique<ImageListSource>(std::move(list), options);
  }
  list.camera_name = (folder / "calibration.txt").string();
  const auto [fx, fy, cx, cy] = ReadIntrinsics(list.camera_name);
  const cv::Size size = SizeOfFirstImage(list);
  Camera& camera = list.camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
  camera.fps = list.rate_hz = 27.1;
  RequirePlausible(camera, list.camera_name);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
