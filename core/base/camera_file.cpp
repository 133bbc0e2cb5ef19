#include "core/base/camera_file.h"

#include <filesystem>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "core/base/mask_file.h"

namespace vpslam {
namespace {

template <class T>
T Get(const YAML::Node& root, const std::string& path, const char* key, const T* fallback) {
  const YAML::Node node = root[key];
  if (!node) {
    if (fallback) return *fallback;
    throw std::runtime_error(path + ": key '" + key +
                             "' is missing; a camera file needs width, height, fx, fy, cx, cy");
  }
  try {
    return node.as<T>();
  } catch (const YAML::Exception&) {
    throw std::runtime_error(path + ": the value of '" + key + "' is not a number; correct it");
  }
}

/// A path that a file names: from its own folder, unless it is absolute.
std::string BesideFile(const std::string& path, const std::string& named) {
  return (std::filesystem::path(path).parent_path() / named).string();
}

}  // namespace

Camera ReadCameraFile(const std::string& path) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(path);
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(path + ": cannot be read; name a calibration file with --camera");
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(path + ": is not YAML (" + e.what() +
                             "); write lines such as 'fx: 525'");
  }
  if (!root.IsMap()) {
    throw std::runtime_error(path + ": holds no 'key: value' lines; write lines such as 'fx: 525'");
  }
  const double zero = 0;
  Camera camera;
  camera.width = Get<int>(root, path, "width", nullptr);
  camera.height = Get<int>(root, path, "height", nullptr);
  camera.fx = Get<double>(root, path, "fx", nullptr);
  camera.fy = Get<double>(root, path, "fy", nullptr);
  camera.cx = Get<double>(root, path, "cx", nullptr);
  camera.cy = Get<double>(root, path, "cy", nullptr);
  camera.fps = Get<double>(root, path, "fps", &camera.fps);
  camera.k1 = Get<double>(root, path, "k1", &zero);
  camera.k2 = Get<double>(root, path, "k2", &zero);
  camera.p1 = Get<double>(root, path, "p1", &zero);
  camera.p2 = Get<double>(root, path, "p2", &zero);
  camera.k3 = Get<double>(root, path, "k3", &zero);
  if (const YAML::Node mask = root["mask"]) {
    if (!mask.IsScalar()) throw std::runtime_error(path + ": 'mask' is no name of a file");
    camera.mask_runs = ReadMaskFile(BesideFile(path, mask.Scalar()), camera.width, camera.height);
  }
  if (const auto why = camera.Validate()) {
    throw std::runtime_error(path + ": " + *why + "; correct the calibration");
  }
  return camera;
}

}  // namespace vpslam
