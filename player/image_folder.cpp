#include "player/image_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "player/folder_reading.h"
#include "player/image_list_source.h"
#include "player/image_series.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

/// `path` may end with a pattern, in which * stands for a number.
struct Place {
  explicit Place(const std::string& path) : folder(path) {
    std::error_code error;
    if (path.find('*') == path.npos || fs::exists(folder, error)) return;
    pattern = folder.filename().string();
    folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  }
  fs::path folder;
  std::string pattern;
};

std::vector<std::string> NamesOf(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.filename().string());
  return names;
}

/// Names that are decimal numbers, as times are, in order of these: 1.5 comes behind 1.25. Not
/// where they mean something else: 1.1 and 1.10 are two.
void SortTimes(std::vector<fs::path>* files) {
  std::map<double, fs::path> by_time;
  for (const fs::path& file : *files) {
    const auto time = ParseNumber(file.stem().string());
    if (!time || file.stem().string().find('.') == std::string::npos) return;
    if (!by_time.emplace(*time, file).second) return;
  }
  files->clear();
  for (const auto& [time, file] : by_time) files->push_back(file);
}

/// A list in a folder above that has the time stamps of the images in this one; empty if there is
/// none.
fs::path ListAbove(const fs::path& folder) {
  std::error_code error;
  fs::path above = fs::absolute(folder, error).lexically_normal();
  for (int levels = 0; levels < 2 && above.has_relative_path(); ++levels) {
    above = above.parent_path();
    for (const char* list : {"rgb.txt", "times.txt", "data.csv"}) {
      if (fs::is_regular_file(above / list, error)) return above / list;
    }
  }
  return {};
}

std::vector<fs::path> FilesOf(const Place& place) {
  std::vector<fs::path> files = ImageFilesIn(place.folder);
  SortTimes(&files);
  if (place.pattern.empty()) return files;
  std::erase_if(files, [&](const fs::path& file) {
    return !MatchesSeries(file.filename().string(), place.pattern);
  });
  return files;
}

/// Of several series that run beside each other the one that is a camera's; throws if that is not
/// clear.
std::vector<fs::path> OneSeries(const Place& place, std::vector<fs::path> files,
                                std::vector<std::string>* notes) {
  const std::vector<ImageSeries> series = ParallelSeries(NamesOf(files));
  if (series.size() < 2) return files;
  const auto is_picture = [](const ImageSeries& s) { return !s.is_companion; };
  const auto chosen = std::find_if(series.begin(), series.end(), is_picture);
  if (std::count_if(series.begin(), series.end(), is_picture) != 1) {
    throw std::runtime_error(
        fmt::format("{}: holds several series of images, {}; name one of them, with its *, as '{}'",
                    place.folder.string(), DescribeSeries(series),
                    (place.folder / series.front().pattern).string()));
  }
  notes->push_back(fmt::format("{}: holds {}; {} is played", place.folder.string(),
                               DescribeSeries(series), chosen->pattern));
  std::vector<fs::path> result;
  for (const size_t i : chosen->images) result.push_back(files[i]);
  return result;
}

}  // namespace

bool IsImageFolder(const std::string& path) { return !FilesOf(Place(path)).empty(); }

std::unique_ptr<ImageSource> OpenImageFolder(const std::string& path,
                                             const SourceOptions& options) {
  const Place place(path);
  ImageList list;
  list.name = path;
  list.unit.clear();
  std::vector<fs::path> files = FilesOf(place);
  if (files.empty()) {
    throw std::runtime_error(path + ": holds no image; name a folder with files such as 0001.png");
  }
  files = OneSeries(place, std::move(files), &list.notes);
  const fs::path above = ListAbove(place.folder);
  if (!above.empty() && options.camera_file.empty() && !fs::exists(place.folder / "camera.yaml")) {
    throw std::runtime_error(path + ": has no camera.yaml; name the folder of the sequence, " +
                             above.parent_path().string() + ", or a calibration with --camera");
  }
  if (!above.empty()) {
    list.notes.push_back(above.string() +
                         ": is not read, since its images' folder alone is played");
  }
  ReadListCamera(place.folder, options, &list);
  if (options.fps > 0) list.camera.fps = options.fps;
  for (size_t i = 0; i < files.size(); ++i) {
    const int64_t stamp_us = std::llround(static_cast<double>(i) * 1e6 / list.camera.fps);
    list.images.push_back({stamp_us, files[i].string()});
  }
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
