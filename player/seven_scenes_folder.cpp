#include "player/seven_scenes_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 30;
constexpr std::string_view kPrefix = "frame-", kEnding = ".color.png";

/// The number of frame-000012.color.png; nullopt for other names.
std::optional<int64_t> NumberOf(const std::string& name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kEnding)) return std::nullopt;
  const auto digits =
      std::string_view(name).substr(kPrefix.size(), name.size() - kPrefix.size() - kEnding.size());
  const auto number = ParseNumber(digits);
  if (!number || digits.find_first_not_of("0123456789") != digits.npos) return std::nullopt;
  return static_cast<int64_t>(*number);
}

/// nullopt where there is no such file or it holds no pose: the data set has some with infinities.
std::optional<SE3> ReadPose(const fs::path& path) {
  std::ifstream file(path);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::string words = text;
  std::replace(words.begin(), words.end(), '\n', ' ');
  std::string_view line = words;
  const auto v = TakeNumbers<16>(&line);
  if (!v) return std::nullopt;
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(v->data());
  const auto rotation = RotationOf(m.topLeftCorner<3, 3>());
  if (!rotation) return std::nullopt;
  return SE3(*rotation, m.topRightCorner<3, 1>());
}

}  // namespace

bool IsSevenScenesFolder(const std::string& path) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    const std::string name = entry.path().filename().string();
    if (!NumberOf(name)) continue;
    const std::string stem = name.substr(0, name.size() - kEnding.size());
    return fs::exists(fs::path(path) / (stem + ".pose.txt"), error) ||
           fs::exists(fs::path(path) / (stem + ".depth.png"), error);
  }
  return false;
}

std::unique_ptr<ImageSource> OpenSevenScenesFolder(const std::string& path,
                                                   const SourceOptions& options) {
  const fs::path folder(path);
  ImageList list;
  list.name = path;
  list.line_form = "frame-000000.color.png";
  list.unit.clear();
  ReadListCamera(folder, options, &list);
  list.truth_name = (folder / "frame-*.pose.txt").string();
  for (const fs::path& file : ImageFilesIn(folder)) {
    const auto number = NumberOf(file.filename().string());
    if (!number) continue;
    const int64_t stamp_us = std::llround(static_cast<double>(*number) * 1e6 / kRateHz);
    list.images.push_back({stamp_us, file.string()});
    const std::string stem = file.stem().stem().string();
    if (const auto pose = ReadPose(folder / (stem + ".pose.txt"))) list.truth.Add(stamp_us, *pose);
  }
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
