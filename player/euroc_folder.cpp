#include "player/euroc_folder.h"

#include <array>
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

constexpr std::string_view kBodyTruth = "state_groundtruth_estimate0";
constexpr const char* kPoseForm = "nanoseconds,px,py,pz,qw,qx,qy,qz";

/// The folder mav0/, whether `path` is it or holds it.
fs::path Mav0(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path / "mav0", error) ? path / "mav0" : path;
}

fs::path CamChain(const fs::path& path) {
  return fs::absolute(Mav0(path)).parent_path() / "dso" / "camchain.yaml";
}

std::string ParseImageLine(std::string_view line, const fs::path& cam0, ListedImage* image) {
  const std::string_view stamp = TakeWord(&line);
  const std::string_view file = Trim(line);
  if (std::string fault = FaultOfNanoseconds(stamp); !fault.empty()) return fault;
  if (file.empty()) return NotOfTheForm("nanoseconds,file");
  image->stamp_us = *ParseNanoseconds_us(stamp);
  image->path = ListedFile(file, {cam0 / "data", cam0});
  return {};
}

/// The pose of the body; what follows it on the line (speed, biases) is left alone.
std::string ParseBodyLine(std::string_view line, StampedPose* pose) {
  const std::string_view stamp = TakeWord(&line);
  const auto v = TakeNumbers<7>(&line);
  if (std::string fault = FaultOfNanoseconds(stamp); !fault.empty()) return fault;
  if (!v) return NotOfTheForm(kPoseForm);
  const auto& [x, y, z, qw, qx, qy, qz] = *v;
  const Eigen::Quaterniond q(qw, qx, qy, qz);
  if (q.norm() < 1e-6) return "has a quaternion of zeros";
  *pose = {*ParseNanoseconds_us(stamp), SE3(q, {x, y, z})};
  return {};
}

/// Reads the first of the truths that a folder may have.
void ReadBodyTruth(const fs::path& mav0, const SE3& body_from_cam, ImageList* list) {
  std::error_code error;
  for (const std::string_view name :
       {kBodyTruth, std::string_view("mocap0"), std::string_view("vicon0")}) {
    const fs::path truth = mav0 / name;
    if (!fs::exists(truth / "data.csv", error)) continue;
    SE3 marker_from_cam = body_from_cam;
    if (name != kBodyTruth && fs::exists(truth / "sensor.yaml", error)) {
      marker_from_cam =
          ReadEurocBodyFromSensor((truth / "sensor.yaml").string()).Inverse() * body_from_cam;
    }
    ReadTruthLines((truth / "data.csv").string(),
                   [&](std::string_view line, int64_t /*index*/, StampedPose* pose) {
                     std::string fault = ParseBodyLine(line, pose);
                     if (fault.empty()) pose->second = pose->second * marker_from_cam;
                     return fault;
                   },
                   list);
    return;
  }
  if (fs::exists(mav0 / "leica0" / "data.csv", error)) {
    list->notes.push_back((mav0 / "leica0" / "data.csv").string() +
                          ": holds positions without rotations, and is not used as truth");
  }
}

std::unique_ptr<ImageSource> Open(const fs::path& mav0, const SourceOptions& options,
                                  const SE3& body_from_cam, ImageList list) {
  const fs::path cam0 = mav0 / "cam0";
  list.name = (cam0 / "data.csv").string();
  list.line_form = "nanoseconds,file";
  list.unit = "nanoseconds";
  list.unit_us = 1e-3;
  if (!options.camera_file.empty()) ReadListCamera(cam0, options, &list);
  ReadImageLines([&](std::string_view line, int64_t /*index*/,
                     ListedImage* image) { return ParseImageLine(line, cam0, image); },
                 &list);
  ReadBodyTruth(mav0, body_from_cam, &list);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace

bool IsEurocFolder(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(Mav0(path) / "cam0" / "data.csv", error);
}

bool IsTumViFolder(const std::string& path) {
  std::error_code error;
  return IsEurocFolder(path) && fs::is_regular_file(CamChain(path), error) &&
         !fs::exists(Mav0(path) / "cam0" / "sensor.yaml", error);
}

std::unique_ptr<ImageSource> OpenEurocFolder(const std::string& path,
                                             const SourceOptions& options) {
  const fs::path mav0 = Mav0(path);
  ImageList list;
  list.camera_name = (mav0 / "cam0" / "sensor.yaml").string();
  std::error_code error;
  if (!options.camera_file.empty() && !fs::exists(list.camera_name, error)) {
    list.notes.push_back(list.camera_name +
                         ": is missing, so the true poses are those of the body");
    return Open(mav0, options, SE3(), std::move(list));
  }
  const EurocSensor sensor = ReadEurocSensor(list.camera_name, options.camera_file.empty());
  list.camera = sensor.camera;
  return Open(mav0, options, sensor.body_from_cam, std::move(list));
}

std::unique_ptr<ImageSource> OpenTumViFolder(const std::string& path,
                                             const SourceOptions& options) {
  ImageList list;
  list.camera_name = CamChain(path).string();
  const EurocSensor sensor = ReadKalibrCamera(list.camera_name, options.camera_file.empty());
  list.camera = sensor.camera;
  return Open(Mav0(path), options, sensor.body_from_cam, std::move(list));
}

}  // namespace vpslam
