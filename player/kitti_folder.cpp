#include "player/kitti_folder.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

std::optional<Matrix34> ParseMatrix(std::string_view line) {
  const auto numbers = TakeNumbers<12>(&line);
  if (!numbers || !Trim(line).empty()) return std::nullopt;
  return Matrix34(numbers->data());
}

/// 0 for the grey camera, 2 for the colour one, -1 for neither.
int CameraNumber(const fs::path& folder) {
  std::error_code error;
  for (const int number : {0, 2}) {
    if (fs::is_directory(folder / fmt::format("image_{}", number), error)) return number;
  }
  return -1;
}

/// P = K [I t] of camera `number`.
Matrix34 ReadProjection(const std::string& path, int number) {
  const std::string name = fmt::format("P{}:", number);
  std::optional<Matrix34> projection;
  std::error_code error;
  if (fs::exists(path, error)) {
    ReadLines(path, [&](std::string_view line) {
      if (TakeWord(&line) == name) projection = ParseMatrix(line);
      return true;
    });
  }
  if (!projection) {
    throw std::runtime_error(
        fmt::format("{}: has no line '{} ' with 12 numbers; take the file of "
                    "the benchmark's calibration archive",
                    path, name));
  }
  return *projection;
}

Camera CameraOf(const Matrix34& projection) {
  Camera camera;
  camera.fx = projection(0, 0);
  camera.fy = projection(1, 1);
  camera.cx = projection(0, 2);
  camera.cy = projection(1, 2);
  return camera;
}

/// cam0_from_cam of a rectified camera: it is turned like camera 0, and x_cam = x_cam0 + t.
SE3 Cam0FromCam(const Matrix34& projection) {
  const Eigen::Matrix3d k = projection.leftCols<3>();
  const Eigen::Vector3d t = k.inverse() * projection.col(3);
  return SE3(Eigen::Quaterniond::Identity(), -t);
}

/// From all time stamps, as no file says it.
double RateHz(const std::vector<ListedImage>& images) {
  const double span_s = 1e-6 * static_cast<double>(images.back().stamp_us - images[0].stamp_us);
  return span_s > 0 ? static_cast<double>(images.size() - 1) / span_s : 10.0;
}

std::string PosesFile(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "poses.txt", error)) return (folder / "poses.txt").string();
  const fs::path sequence = fs::canonical(folder, error);  // "." has a name, too
  return (sequence / ".." / ".." / "poses" / (sequence.filename().string() + ".txt")).string();
}

void ReadTimes(const SourceOptions& options, const fs::path& images, ImageList* list) {
  const std::vector<fs::path> files = ImageFilesIn(images);
  if (files.empty())
    throw std::runtime_error(images.string() + ": holds no image; is it unpacked?");
  const std::string ending = files.front().extension().string();
  size_t index = 0;
  ReadImageLines(
      options,
      [&](std::string_view line) -> std::optional<ListedImage> {
        const std::string name = fmt::format("{:06}{}", index++, ending);
        const auto stamp_us = ParseStamp_us(TakeWord(&line));
        if (!stamp_us) return std::nullopt;
        return ListedImage{*stamp_us, (images / name).string()};
      },
      list);
  if (files.size() != index) {
    options.tell(fmt::format("{}: has {} lines, but {} holds {} images; they go together by number",
                             list->name, index, images.string(), files.size()));
  }
}

}  // namespace

bool IsKittiFolder(const std::string& path) {
  std::error_code error;
  return CameraNumber(path) >= 0 && fs::is_regular_file(fs::path(path) / "times.txt", error);
}

std::unique_ptr<ImageSource> OpenKittiFolder(const std::string& path,
                                             const SourceOptions& options) {
  const fs::path folder(path);
  const int number = CameraNumber(folder);
  if (number < 0) throw std::runtime_error(path + ": holds neither image_0/ nor image_2/");
  ImageList list;
  list.name = (folder / "times.txt").string();
  list.line_form = "seconds";
  ReadTimes(options, folder / fmt::format("image_{}", number), &list);

  list.camera_name = (folder / "calib.txt").string();
  SE3 cam0_from_cam;
  if (options.camera_file.empty() || number != 0) {
    const Matrix34 projection = ReadProjection(list.camera_name, number);
    list.camera = CameraOf(projection);
    if (projection(0, 0) > 0 && projection(1, 1) > 0) cam0_from_cam = Cam0FromCam(projection);
  }
  if (!options.camera_file.empty()) {
    list.camera_name = options.camera_file;
    list.camera = ReadCameraFile(options.camera_file);
  } else {
    const cv::Size size = SizeOfFirstImage(list);
    list.camera.width = size.width;
    list.camera.height = size.height;
    list.camera.fps = RateHz(list.images);
    if (const auto why = list.camera.Validate()) {
      throw std::runtime_error(list.camera_name + ": " + *why + "; correct the calibration");
    }
  }

  std::vector<std::optional<int64_t>> stamps_us;  // by number; ReadTimes left bad lines out
  ReadLines(list.name, [&](std::string_view line) {
    stamps_us.push_back(ParseStamp_us(TakeWord(&line)));
    return true;
  });
  size_t index = 0;
  ReadTruthLines(
      options, PosesFile(folder), "12 numbers [R t]",
      [&](std::string_view line) -> std::optional<StampedPose> {
        const size_t i = index++;
        const auto m = ParseMatrix(line);
        if (!m || i >= stamps_us.size() || !stamps_us[i]) return std::nullopt;
        const Eigen::Matrix3d rotation = m->leftCols<3>();
        if (std::abs(rotation.determinant() - 1) > 1e-2) return std::nullopt;
        const SE3 world_from_cam0(Eigen::Quaterniond(rotation).normalized(), m->col(3));
        return StampedPose(*stamps_us[i], world_from_cam0 * cam0_from_cam);
      },
      &list.truth);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
