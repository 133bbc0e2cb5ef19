#include "core/base/camera_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include <yaml-cpp/yaml.h>

#include "core/base/mask_file.h"
#include "core/base/yaml_keys.h"
#include "core/geometry/camera_plausibility.h"

namespace vpslam {
namespace {

constexpr std::array kKeys = {"width", "height", "fps", "fx", "fy", "cx",  "cy",
                              "k1",    "k2",     "p1",  "p2", "k3", "mask"};

std::string ReadText(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, error)) {
    throw std::runtime_error("cannot be read; name a calibration file with --camera");
  }
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw std::runtime_error("is UTF-16; save it as UTF-8");
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  // OpenCV begins its files so, which is no YAML; blanks keep the numbers of the lines.
  if (text.starts_with("%YAML:")) {
    const auto end =
        text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find('\n'), text.size()));
    std::fill(text.begin(), end, ' ');
  }
  return text;
}

/// Calibrations of other programs, by a key of theirs, and what to do with them.
void RefuseForeign(const YAML::Node& root) {
  constexpr const char* kRewrite = "; write its numbers as width, height, fx, fy, cx, cy, k1, ...";
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
    const auto is = [&](std::string_view name) { return key == name; };
    if (is("k4") || is("k5") || is("k6")) {
      throw std::runtime_error(
          "has the key '" + key +
          "' of a rational lens or a fisheye, which is not modelled; calibrate "
          "with k1, k2, p1, p2, k3, or undistort the images");
    }
    if (key.starts_with("Camera.") || key.starts_with("Camera1.")) {
      throw std::runtime_error("is a settings file of ORB-SLAM (" + key + ")" + kRewrite);
    }
    if (is("camera_matrix") || is("image_width") || is("distortion_coefficients")) {
      throw std::runtime_error("is a calibration of ROS or OpenCV (" + key + ")" + kRewrite);
    }
    if (is("cam0")) throw std::runtime_error(std::string("is a camchain of Kalibr") + kRewrite);
    if (is("intrinsics")) {
      throw std::runtime_error(std::string("is a sensor.yaml of EuRoC or the like") + kRewrite);
    }
  }
}

template <class T>
T Get(const YAML::Node& root, const char* key, const T* fallback) {
  const YAML::Node node = root[key];
  if (!node) {
    if (fallback) return *fallback;
    throw std::runtime_error(std::string("key '") + key +
                             "' is missing; a camera file needs width, height, fx, fy, cx, cy");
  }
  double value = 0;
  try {
    value = node.as<double>();
  } catch (const YAML::Exception&) {
    throw std::runtime_error("line " + std::to_string(node.Mark().line + 1) + ": the value of '" +
                             key + "' is not a number; correct it");
  }
  const bool is_whole = std::trunc(value) == value && std::abs(value) < 1e9;
  if (std::is_integral_v<T> && !is_whole) {
    throw std::runtime_error("line " + std::to_string(node.Mark().line + 1) + ": '" + key +
                             "' has to be a whole number of px");
  }
  return static_cast<T>(value);
}

Camera Parse(const YAML::Node& root) {
  if (!root.IsMap()) {
    throw std::runtime_error("holds no 'key: value' lines; write lines such as 'fx: 525'");
  }
  RefuseForeign(root);
  RefuseRepeatedKeys(root);
  RefuseUnknownKeys(root, kKeys);
  const double zero = 0;
  Camera camera;
  camera.width = Get<int>(root, "width", nullptr);
  camera.height = Get<int>(root, "height", nullptr);
  camera.fx = Get<double>(root, "fx", nullptr);
  camera.fy = Get<double>(root, "fy", nullptr);
  camera.cx = Get<double>(root, "cx", nullptr);
  camera.cy = Get<double>(root, "cy", nullptr);
  camera.fps = Get<double>(root, "fps", &camera.fps);
  camera.k1 = Get<double>(root, "k1", &zero);
  camera.k2 = Get<double>(root, "k2", &zero);
  camera.p1 = Get<double>(root, "p1", &zero);
  camera.p2 = Get<double>(root, "p2", &zero);
  camera.k3 = Get<double>(root, "k3", &zero);
  return camera;
}

/// A path that a file names: from its own folder, unless it is absolute.
std::string BesideFile(const std::string& path, const std::string& named) {
  return (std::filesystem::path(path).parent_path() / named).string();
}

}  // namespace

Camera ReadCameraFile(const std::string& path) {
  YAML::Node root;
  Camera camera;
  try {
    root = YAML::Load(ReadText(path));
    camera = Parse(root);
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(path + ": is not YAML (" + e.what() +
                             "); write lines such as 'fx: 525'");
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(path + ": " + e.what());
  }
  RequirePlausible(camera, path);
  if (const YAML::Node mask = root["mask"]) {
    if (!mask.IsScalar()) throw std::runtime_error(path + ": 'mask' is no name of a file");
    camera.mask_runs = ReadMaskFile(BesideFile(path, mask.Scalar()), camera.width, camera.height);
  }
  return camera;
}

}  // namespace vpslam
