#include "player/euroc_sensor.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <Eigen/LU>
#include <yaml-cpp/yaml.h>

#include "core/base/yaml_keys.h"
#include "core/geometry/camera_plausibility.h"

namespace vpslam {
namespace {

/// Names of our model, pinhole with radial-tangential distortion, in calibrations of others.
constexpr std::string_view kPinhole[] = {"pinhole"};
constexpr std::string_view kRadialTangential[] = {"radial-tangential", "radtan", "plumb_bob"};

/// The value of `key`, checked for its number of elements; `at_most` allows for optional ones.
template <class T>
std::vector<T> GetList(const YAML::Node& root, const char* key, size_t at_least, size_t at_most) {
  const YAML::Node node = root[key];
  if (!node) throw std::runtime_error(std::string("key '") + key + "' is missing");
  std::vector<T> values;
  try {
    values = node.as<std::vector<T>>();
  } catch (const YAML::Exception&) {
    throw std::runtime_error(std::string("the value of '") + key + "' is no list of numbers");
  }
  if (values.size() < at_least || values.size() > at_most) {
    throw std::runtime_error(std::string("the list '") + key + "' has " +
                             std::to_string(values.size()) + " numbers, not " +
                             std::to_string(at_least));
  }
  return values;
}

template <size_t N>
void RequireModel(const YAML::Node& root, const char* key, const std::string_view (&known)[N]) {
  const auto found = root[key].as<std::string>(std::string(known[0]));
  if (std::find(std::begin(known), std::end(known), found) == std::end(known)) {
    throw std::runtime_error(std::string(key) + " is '" + found + "' but only '" +
                             std::string(known[0]) +
                             "' is supported; undistort the images and name their calibration "
                             "with --camera");
  }
}

SE3 PoseOf(const std::vector<double>& data, const char* key) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(data.data());
  const Eigen::Matrix3d rotation = m.topLeftCorner<3, 3>();
  if (!m.allFinite() || std::abs(rotation.determinant() - 1) > 1e-3 ||
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3) {
    throw std::runtime_error(std::string(key) + " is no rigid transformation");
  }
  return SE3(Eigen::Quaterniond(rotation).normalized(), m.topRightCorner<3, 1>());
}

SE3 ReadPose(const YAML::Node& root) {
  if (!root["T_BS"]) return SE3();
  return PoseOf(GetList<double>(root["T_BS"], "data", 16, 16), "T_BS");
}

Camera ReadCamera(const YAML::Node& root, const char* coefficients) {
  RequireModel(root, "camera_model", kPinhole);
  RequireModel(root, "distortion_model", kRadialTangential);
  const auto size = GetList<int>(root, "resolution", 2, 2);
  const auto k = GetList<double>(root, "intrinsics", 4, 4);
  auto d = GetList<double>(root, coefficients, 4, 14);
  if (std::any_of(d.begin() + std::min<std::ptrdiff_t>(5, std::ssize(d)), d.end(),
                  [](double value) { return value != 0; })) {
    throw std::runtime_error(std::string(coefficients) + " has " + std::to_string(d.size()) +
                             " numbers: a rational lens, which is not modelled; calibrate with "
                             "five coefficients, or undistort the images");
  }
  d.resize(5, 0.0);
  Camera c;
  c.width = size[0];
  c.height = size[1];
  c.fps = root["rate_hz"].as<double>(c.fps);
  c.fx = k[0];
  c.fy = k[1];
  c.cx = k[2];
  c.cy = k[3];
  c.k1 = d[0];
  c.k2 = d[1];
  c.p1 = d[2];
  c.p2 = d[3];
  c.k3 = d[4];
  if (const auto why = c.Validate()) throw std::runtime_error(*why);
  if (const auto why = WhyImplausible(c)) throw std::runtime_error(*why);
  return c;
}

/// Reads `path`, and names it in whatever goes wrong.
template <class T>
T Load(const std::string& path, const std::function<T(const YAML::Node&)>& read) {
  try {
    const YAML::Node root = YAML::LoadFile(path);
    if (!root.IsMap()) throw std::runtime_error("holds no 'key: value' lines");
    RefuseRepeatedKeys(root);
    return read(root);
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(path + ": cannot be read; name a calibration file with --camera");
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(path + ": is not YAML (" + e.what() +
                             "); take the file of the data set, or name another with --camera");
  } catch (const std::runtime_error& e) {
    const std::string what = e.what();
    const bool has_remedy = what.find(';') != what.npos;
    throw std::runtime_error(path + ": " + what + (has_remedy ? "" : "; correct the calibration"));
  }
}

}  // namespace

EurocSensor ReadEurocSensor(const std::string& path, bool with_camera) {
  return Load<EurocSensor>(path, [&](const YAML::Node& root) {
    EurocSensor sensor;
    if (with_camera) sensor.camera = ReadCamera(root, "distortion_coefficients");
    sensor.body_from_cam = ReadPose(root);
    return sensor;
  });
}

EurocSensor ReadKalibrCamera(const std::string& path, bool with_camera) {
  return Load<EurocSensor>(path, [&](const YAML::Node& root) {
    const YAML::Node cam0 = root["cam0"];
    if (!cam0 || !cam0.IsMap()) throw std::runtime_error("key 'cam0' is missing");
    EurocSensor sensor;
    if (with_camera) {
      sensor.camera = ReadCamera(cam0, "distortion_coeffs");
      sensor.camera.fps = 20;  // of TUM-VI; the file does not say it
    }
    if (cam0["T_cam_imu"]) {
      std::vector<double> data;
      for (const YAML::Node& row : cam0["T_cam_imu"]) {
        for (const double value : row.as<std::vector<double>>()) data.push_back(value);
      }
      if (data.size() != 16) throw std::runtime_error("T_cam_imu does not have 16 numbers");
      sensor.body_from_cam = PoseOf(data, "T_cam_imu").Inverse();
    }
    return sensor;
  });
}

SE3 ReadEurocBodyFromSensor(const std::string& path) {
  return Load<SE3>(path, [](const YAML::Node& root) { return ReadPose(root); });
}

}  // namespace vpslam
