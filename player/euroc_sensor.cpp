#include "player/euroc_sensor.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/LU>
#include <yaml-cpp/yaml.h>

namespace vpslam {
namespace {

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

void RequireModel(const YAML::Node& root, const char* key, const std::string& wanted) {
  const auto found = root[key].as<std::string>(wanted);
  if (found != wanted) {
    throw std::runtime_error(std::string(key) + " is '" + found + "' but only '" + wanted +
                             "' is supported; undistort the images and name their calibration "
                             "with --camera");
  }
}

SE3 ReadPose(const YAML::Node& root) {
  if (!root["T_BS"]) return SE3();
  const auto data = GetList<double>(root["T_BS"], "data", 16, 16);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(data.data());
  const Eigen::Matrix3d rotation = m.topLeftCorner<3, 3>();
  if (!m.allFinite() || std::abs(rotation.determinant() - 1) > 1e-3 ||
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3) {
    throw std::runtime_error("T_BS is no rigid transformation");
  }
  return SE3(Eigen::Quaterniond(rotation).normalized(), m.topRightCorner<3, 1>());
}

EurocSensor Parse(const YAML::Node& root) {
  if (!root.IsMap()) throw std::runtime_error("holds no 'key: value' lines");
  RequireModel(root, "camera_model", "pinhole");
  RequireModel(root, "distortion_model", "radial-tangential");
  const auto size = GetList<int>(root, "resolution", 2, 2);
  const auto k = GetList<double>(root, "intrinsics", 4, 4);
  const auto d = GetList<double>(root, "distortion_coefficients", 4, 5);
  EurocSensor sensor;
  Camera& c = sensor.camera;
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
  c.k3 = d.size() > 4 ? d[4] : 0;
  if (const auto why = c.Validate()) throw std::runtime_error(*why);
  sensor.body_from_cam = ReadPose(root);
  return sensor;
}

}  // namespace

EurocSensor ReadEurocSensor(const std::string& path) {
  try {
    return Parse(YAML::LoadFile(path));
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(path + ": cannot be read; name a calibration file with --camera");
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(path + ": is not YAML (" + e.what() +
                             "); take the file of the data set, or name another with --camera");
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(path + ": " + e.what() + "; correct the calibration");
  }
}

}  // namespace vpslam
