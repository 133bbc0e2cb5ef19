#include "player/folder_reading.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "core/base/decode_image.h"
#include "player/bad_frame_guard.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// True for '1000,033 file': the word before the comma and that behind it are one number.
bool HasDecimalComma(std::string_view line) {
  const size_t comma = line.find(',');
  if (comma == std::string_view::npos || comma == 0 || !IsDigit(line[comma - 1])) return false;
  const size_t end = line.find_first_not_of("0123456789", comma + 1);
  const bool digits = end != comma + 1;
  return digits && end != std::string_view::npos && (line[end] == ' ' || line[end] == '\t');
}

/// Cuts the leading digits off `text`, and gives them without leading zeros.
std::string_view TakeDigits(std::string_view* text) {
  size_t end = 0;
  while (end < text->size() && IsDigit((*text)[end])) ++end;
  std::string_view digits = text->substr(0, end);
  text->remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

}  // namespace

void ReadImageLines(const ParseImage& parse, ImageList* list) {
  const LineCounts counts =
      ReadLines(list->name, [&](std::string_view line, const LinePlace& place) {
        ListedImage image;
        std::string fault = parse(line, place.index, &image);
        image.line = place.number;
        if (fault.empty()) list->images.push_back(std::move(image));
        return fault;
      });
  if (counts.refused == 0) return;
  list->skipped["line of the list unreadable"] = counts.refused;
  list->first_skipped = counts.Describe(list->name);
}

void ReadTruthLines(const std::string& path, const ParsePose& parse, ImageList* list) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  list->truth_name = path;
  try {
    const LineCounts counts = ReadLines(path, [&](std::string_view line, const LinePlace& place) {
      StampedPose pose;
      std::string fault = parse(line, place.index, &pose);
      if (fault.empty()) list->truth.Add(pose.first, pose.second);
      return fault;
    });
    if (counts.refused > 0) list->notes.push_back(counts.Describe(path) + ", skipped");
  } catch (const std::runtime_error& e) {
    list->notes.emplace_back(e.what());
  }
}

std::string ParseSecondsAndFile(std::string_view line, const fs::path& folder, ListedImage* image) {
  std::string_view rest = line;
  const std::string_view stamp = TakeWord(&rest);
  const std::string_view file = Trim(rest);
  if (!ParseNumber(stamp) || file.empty()) return NotOfTheForm("seconds file");
  if (std::string fault = FaultOfSeconds(stamp); !fault.empty()) return fault;
  if (HasDecimalComma(line)) return "has a decimal comma; write times with a point";
  image->stamp_us = *ParseStamp_us(stamp);
  image->path = ListedFile(file, {folder});
  return {};
}

std::string ParseTumLine(std::string_view line, int64_t /*index*/, StampedPose* pose) {
  constexpr const char* kForm = "seconds tx ty tz qx qy qz qw";
  line = line.substr(0, line.find('#'));
  const size_t words = CountWords(line);
  if (words == 12) {
    return fmt::format("has 12 numbers, as KITTI's poses have; write '{}'", kForm);
  }
  const std::string_view stamp = TakeWord(&line);
  const auto parsed = ParseTumPose(line);
  if (words != 8 || !ParseNumber(stamp) || !parsed) return NotOfTheForm(kForm);
  if (std::string fault = FaultOfSeconds(stamp); !fault.empty()) return fault;
  *pose = {*ParseStamp_us(stamp), *parsed};
  return {};
}

std::optional<SE3> ParseTumPose(std::string_view line) {
  const auto v = TakeNumbers<7>(&line);
  if (!v) return std::nullopt;
  const auto& [x, y, z, qx, qy, qz, qw] = *v;
  const Eigen::Quaterniond q(qw, qx, qy, qz);
  if (q.norm() < 1e-6) return std::nullopt;
  return SE3(q, {x, y, z});
}

std::optional<Eigen::Quaterniond> RotationOf(const Eigen::Matrix3d& matrix) {
  constexpr double kTolerance = 1e-2;
  if (!matrix.allFinite() || std::abs(matrix.determinant() - 1) > kTolerance ||
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm() > 2 * kTolerance) {
    return std::nullopt;
  }
  return Eigen::Quaterniond(matrix).normalized();
}

std::string ListedFile(std::string_view rest, const std::vector<fs::path>& folders) {
  std::string_view left = rest;
  std::vector<std::string> names = {std::string(rest), std::string(TakeWord(&left))};
  for (size_t i = 0; i < 2; ++i) {
    std::string turned = names[i];
    std::replace(turned.begin(), turned.end(), '\\', '/');
    names.push_back(std::move(turned));
  }
  for (const std::string& name : names) {
    for (const fs::path& folder : folders) {
      std::error_code error;
      if (!name.empty() && fs::is_regular_file(folder / name, error)) {
        return (folder / name).string();
      }
    }
  }
  return (folders.front() / names.front()).string();
}

bool HasImageEnding(const fs::path& path) {
  constexpr std::array<std::string_view, 9> kEndings = {".png", ".jpg", ".jpeg", ".pgm", ".ppm",
                                                        ".bmp", ".tif", ".tiff", ".webp"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

std::vector<fs::path> ImageFilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    std::error_code status_error;
    const fs::path& path = entry.path();
    const bool hidden = path.filename().string().starts_with('.');
    if (!hidden && HasImageEnding(path) && entry.is_regular_file(status_error)) {
      files.push_back(path);
    }
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return NaturallyBefore(a.filename().string(), b.filename().string());
  });
  return files;
}

bool NaturallyBefore(const std::string& a, const std::string& b) {
  std::string_view x = a, y = b;
  while (!x.empty() && !y.empty()) {
    if (IsDigit(x.front()) && IsDigit(y.front())) {
      const std::string_view m = TakeDigits(&x), n = TakeDigits(&y);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (x.front() != y.front()) return x.front() < y.front();
      x.remove_prefix(1);
      y.remove_prefix(1);
    }
  }
  if (x.empty() != y.empty()) return x.empty();
  return a < b;  // 1.png and 01.png: any order, but always the same
}

cv::Size SizeOfFirstImage(const ImageList& list) {
  RequireMost(list);  // which says what is wrong with a list without any
  const size_t tries = std::min<size_t>(list.images.size(), BadFrameOptions().max_at_start + 1);
  std::string fault = "is not listed";
  for (size_t i = 0; i < tries; ++i) {
    const DecodedImage image = DecodeGrey(list.images[i].path);
    if (image.fault.empty()) return image.grey.size();
    if (i == 0) fault = image.fault;
  }
  throw std::runtime_error(list.images.front().path + ": " + fault +
                           ", and so are the next ones; is the copy complete?");
}

void ReadListCamera(const fs::path& folder, const SourceOptions& options, ImageList* list) {
  list->camera_name =
      options.camera_file.empty() ? (folder / "camera.yaml").string() : options.camera_file;
  list->camera = ReadCameraFile(list->camera_name);
}

}  // namespace vpslam
