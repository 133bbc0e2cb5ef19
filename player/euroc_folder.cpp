#include "player/euroc_folder.h"

#include <filesystem>
#include <utility>

#include "core/base/camera_file.h"
#include "player/euroc_sensor.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

/// The folder mav0/, whether `path` is it or holds it.
fs::path Mav0(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path / "mav0", error) ? path / "mav0" : path;
}

std::optional<ListedImage> ParseImageLine(std::string_view line, const fs::path& folder) {
  const auto stamp_us = ParseNanoseconds_us(TakeWord(&line));
  const std::string_view file = Trim(line);
  if (!stamp_us || file.empty()) return std::nullopt;
  return ListedImage{*stamp_us, (folder / file).string()};
}

/// The pose of the body; what follows it on the line (speed, biases) is left alone.
std::optional<StampedPose> ParseBodyLine(std::string_view line) {
  const auto stamp_us = ParseNanoseconds_us(TakeWord(&line));
  const auto v = TakeNumbers<7>(&line);
  if (!stamp_us || !v) return std::nullopt;
  const auto& [x, y, z, qw, qx, qy, qz] = *v;
  const Eigen::Quaterniond q(qw, qx, qy, qz);
  if (q.norm() < 1e-6) return std::nullopt;
  return StampedPose(*stamp_us, SE3(q, {x, y, z}));
}

}  // namespace

bool IsEurocFolder(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(Mav0(path) / "cam0" / "data.csv", error);
}

std::unique_ptr<ImageSource> OpenEurocFolder(const std::string& path,
                                             const SourceOptions& options) {
  const fs::path mav0 = Mav0(path), cam0 = mav0 / "cam0";
  ImageList list;
  list.name = (cam0 / "data.csv").string();
  list.line_form = "nanoseconds,file";
  list.camera_name = (cam0 / "sensor.yaml").string();
  const EurocSensor sensor = ReadEurocSensor(list.camera_name);
  list.camera = sensor.camera;
  if (!options.camera_file.empty()) {
    list.camera_name = options.camera_file;
    list.camera = ReadCameraFile(options.camera_file);
  }
  ReadImageLines(
      options, [&](std::string_view line) { return ParseImageLine(line, cam0 / "data"); }, &list);
  const auto parse = [&](std::string_view line) -> std::optional<StampedPose> {
    const auto body = ParseBodyLine(line);
    if (!body) return std::nullopt;
    return StampedPose(body->first, body->second * sensor.body_from_cam);
  };
  ReadTruthLines(options, (mav0 / "state_groundtruth_estimate0" / "data.csv").string(),
                 "nanoseconds,px,py,pz,qw,qx,qy,qz,...", parse, &list.truth);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
