#include "player/image_folder.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "core/base/camera_file.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"

namespace vpslam {

namespace fs = std::filesystem;

bool IsImageFolder(const std::string& path) { return !ImageFilesIn(path).empty(); }

std::unique_ptr<ImageSource> OpenImageFolder(const std::string& path,
                                             const SourceOptions& options) {
  const std::vector<fs::path> files = ImageFilesIn(path);
  if (files.empty()) {
    throw std::runtime_error(path + ": holds no image; name a folder with files such as 0001.png");
  }
  ImageList list;
  list.name = path;
  list.camera_name =
      options.camera_file.empty() ? (fs::path(path) / "camera.yaml").string() : options.camera_file;
  list.camera = ReadCameraFile(list.camera_name);
  if (options.fps > 0) list.camera.fps = options.fps;
  for (size_t i = 0; i < files.size(); ++i) {
    const int64_t stamp_us = std::llround(static_cast<double>(i) * 1e6 / list.camera.fps);
    list.images.push_back({stamp_us, files[i].string()});
  }
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
