#include "player/kitti_folder.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "core/geometry/camera_plausibility.h"
#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 10;  // as published

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
    ReadLines(path, [&](std::string_view line, const LinePlace&) {
      if (TakeWord(&line) == name) projection = ParseMatrix(line);
      return std::string();
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
  const auto [first, last] = std::minmax_element(
      images.begin(), images.end(),
      [](const ListedImage& a, const ListedImage& b) { return a.stamp_us < b.stamp_us; });
  const double span_s = 1e-6 * static_cast<double>(last->stamp_us - first->stamp_us);
  const double rate_hz = static_cast<double>(images.size() - 1) / span_s;
  return span_s > 0 && rate_hz < 1000 ? rate_hz : kRateHz;
}

std::string PosesFile(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "poses.txt", error)) return (folder / "poses.txt").string();
  const fs::path sequence = fs::canonical(folder, error);  // "." has a name, too
  return (sequence / ".." / ".." / "poses" / (sequence.filename().string() + ".txt")).string();
}

/// Images by number: that of their names, where the first line's image is there, or the order of
/// the names where these count otherwise.
class NumberedFiles {
 public:
  explicit NumberedFiles(const fs::path& folder) : files_(ImageFilesIn(folder)) {
    if (files_.empty())
      throw std::runtime_error(folder.string() + ": holds no image; is it unpacked?");
    for (const fs::path& file : files_) {
      if (const auto number = ParseNumber(file.stem().string())) {
        by_number_[static_cast<int64_t>(*number)] = file;
      }
    }
    ending_ = files_.front().extension().string();
    folder_ = folder;
  }

  size_t size() const { return files_.size(); }

  std::string Path(int64_t number) const {
    if (!by_number_.contains(0)) {  // numbered from another number on
      return number < std::ssize(files_) ? files_[static_cast<size_t>(number)].string()
                                         : Missing(number);
    }
    const auto found = by_number_.find(number);
    return found != by_number_.end() ? found->second.string() : Missing(number);
  }

 private:
  std::string Missing(int64_t number) const {
    return (folder_ / fmt::format("{:06}{}", number, ending_)).string();
  }

  std::vector<fs::path> files_;
  std::map<int64_t, fs::path> by_number_;
  std::string ending_;
  fs::path folder_;
};

/// The stamps by number, of good lines.
std::vector<std::optional<int64_t>> ReadTimes(const fs::path& images, ImageList* list) {
  const NumberedFiles files(images);
  std::vector<std::optional<int64_t>> stamps_us;
  ReadImageLines(
      [&](std::string_view line, int64_t index, ListedImage* image) -> std::string {
        const std::string_view stamp = TakeWord(&line);
        stamps_us.resize(static_cast<size_t>(index) + 1);
        if (std::string fault = FaultOfSeconds(stamp); !fault.empty()) return fault;
        image->stamp_us = *ParseStamp_us(stamp);
        image->path = files.Path(index);
        stamps_us.back() = image->stamp_us;
        return {};
      },
      list);
  if (files.size() > stamps_us.size()) {
    list->skipped["no time stamp"] += static_cast<int64_t>(files.size() - stamps_us.size());
    if (list->first_skipped.empty()) {
      list->first_skipped = fmt::format("{}: has {} lines, but {} holds {} images", list->name,
                                        stamps_us.size(), images.string(), files.size());
    }
  }
  return stamps_us;
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
  const auto stamps_us = ReadTimes(folder / fmt::format("image_{}", number), &list);

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
    list.rate_hz = kRateHz;
    list.camera.fps = RateHz(list.images);
    RequirePlausible(list.camera, list.camera_name);
  }

  ReadTruthLines(
      PosesFile(folder),
      [&](std::string_view line, int64_t index, StampedPose* pose) -> std::string {
        const auto i = static_cast<size_t>(index);
        const auto m = ParseMatrix(line);
        if (!m) return NotOfTheForm("12 numbers [R t]");
        if (i >= stamps_us.size() || !stamps_us[i]) return "has no image of its number";
        const auto rotation = RotationOf(m->leftCols<3>());
        if (!rotation) return "has no rotation matrix in its columns 1 to 3";
        *pose = {*stamps_us[i], SE3(*rotation, m->col(3)) * cam0_from_cam};
        return {};
      },
      &list);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
