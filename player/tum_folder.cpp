#include "player/tum_folder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "player/image_list_source.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBlanks = " \t\r";

/// Cuts the first word off `line`.
std::string_view TakeWord(std::string_view* line) {
  line->remove_prefix(std::min(line->find_first_not_of(kBlanks), line->size()));
  const std::string_view word = line->substr(0, line->find_first_of(kBlanks));
  line->remove_prefix(word.size());
  return word;
}

std::string_view Trim(std::string_view s) {
  s.remove_prefix(std::min(s.find_first_not_of(kBlanks), s.size()));
  return s.substr(0, s.find_last_not_of(kBlanks) + 1);
}

std::optional<double> ParseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<ListedImage> ParseImageLine(std::string_view line, const fs::path& folder) {
  const auto stamp_us = ParseStamp_us(TakeWord(&line));
  const std::string_view file = Trim(line);  // the rest of the line: names may contain blanks
  if (!stamp_us || file.empty()) return std::nullopt;
  return ListedImage{*stamp_us, (folder / file).string()};
}

bool AddTruthLine(std::string_view line, TruthTrack* truth) {
  const auto stamp_us = ParseStamp_us(TakeWord(&line));
  std::array<double, 7> v;
  for (double& x : v) {
    const auto number = ParseNumber(TakeWord(&line));
    if (!number) return false;
    x = *number;
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!stamp_us || q.norm() < 1e-6) return false;
  truth->Add(*stamp_us, SE3(q, {v[0], v[1], v[2]}));
  return true;
}

struct LineCounts {
  int64_t lines = 0;    ///< without comments and empty ones
  int64_t refused = 0;  ///< of them
  int64_t first_refused_number = 0;

  std::string Describe(const std::string& path, const char* form) const {
    return fmt::format("{}:{}: is not of the form '{}'; so are {} of {} lines", path,
                       first_refused_number, form, refused, lines);
  }
};

/// Calls `use` with each line that is neither empty nor a comment; it returns false to refuse one.
template <class Use>
LineCounts ReadLines(const std::string& path, const Use& use) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read; check its permissions");
  LineCounts counts;
  int64_t number = 0;
  for (std::string text; std::getline(file, text);) {
    ++number;
    const std::string_view line = Trim(text);
    if (line.empty() || line.front() == '#') continue;
    ++counts.lines;
    if (!use(line) && ++counts.refused == 1) counts.first_refused_number = number;
  }
  return counts;
}

void ReadImages(const SourceOptions& options, const fs::path& folder, ImageList* list) {
  const LineCounts counts = ReadLines(list->name, [&](std::string_view line) {
    auto image = ParseImageLine(line, folder);
    if (image) list->images.push_back(std::move(*image));
    return image.has_value();
  });
  if (counts.refused == 0) return;
  const std::string what = counts.Describe(list->name, "seconds file");
  const BadFrameOptions limits;
  if (list->images.empty() ||
      counts.refused >
          std::max(limits.always_allowed,
                   static_cast<int64_t>(limits.max_fraction * static_cast<double>(counts.lines)))) {
    throw std::runtime_error(what + "; correct the file");
  }
  options.tell(what + ", skipped");
}

/// Truth is for viewers and tests: what is wrong with it is told, but stops nothing.
void ReadTruth(const SourceOptions& options, const std::string& path, TruthTrack* truth) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  const LineCounts counts =
      ReadLines(path, [&](std::string_view line) { return AddTruthLine(line, truth); });
  if (counts.refused == 0) return;
  options.tell(counts.Describe(path, "seconds tx ty tz qx qy qz qw") + ", skipped");
}

}  // namespace

std::optional<int64_t> ParseStamp_us(std::string_view text) {
  // A double holds microseconds exactly enough for 285 years since 1970.
  const auto seconds = ParseNumber(text);
  if (!seconds || std::abs(*seconds) > 9e9) return std::nullopt;
  return std::llround(*seconds * 1e6);
}

bool IsTumFolder(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(fs::path(path) / "rgb.txt", error);
}

std::unique_ptr<ImageSource> OpenTumFolder(const std::string& path, const SourceOptions& options) {
  const fs::path folder(path);
  ImageList list;
  list.name = (folder / "rgb.txt").string();
  list.camera_name =
      options.camera_file.empty() ? (folder / "camera.yaml").string() : options.camera_file;
  list.camera = ReadCameraFile(list.camera_name);
  ReadImages(options, folder, &list);
  ReadTruth(options, (folder / "groundtruth.txt").string(), &list.truth);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
