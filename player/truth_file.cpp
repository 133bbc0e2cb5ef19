#include "player/truth_file.h"

#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <spdlog/spdlog.h>

namespace vpslam {

TruthFile::TruthFile(std::string path) : path_(std::move(path)) {
  std::error_code error;
  std::filesystem::remove(path_, error);
}

void TruthFile::Add(int64_t stamp_us, const SE3& world_from_cam) {
  if (is_given_up_) return;
  if (!file_.is_open()) {
    file_.open(path_, std::ios::binary);
    if (!file_) {
      throw std::runtime_error(
          path_ + ": cannot be written; name a file in a folder with write permission");
    }
    fmt::print(file_, "# true poses: timestamp tx ty tz qx qy qz qw, camera-to-world, m\n");
  }
  const Eigen::Vector3d& t = world_from_cam.translation;
  const Eigen::Quaterniond& q = world_from_cam.rotation;
  const int64_t magnitude_us = stamp_us < 0 ? -stamp_us : stamp_us;
  fmt::print(file_, "{}{}.{:06} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
             stamp_us < 0 ? "-" : "", magnitude_us / 1'000'000, magnitude_us % 1'000'000, t.x(),
             t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  file_.flush();
  if (!file_) {
    spdlog::warn("{}: cannot be written any more; free space", path_);
    is_given_up_ = true;
  }
}

}  // namespace vpslam
