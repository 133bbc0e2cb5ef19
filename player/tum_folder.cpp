#include "player/tum_folder.h"

#include <filesystem>
#include <utility>

#include "player/folder_reading.h"
#include "player/image_list_source.h"

namespace vpslam {

namespace fs = std::filesystem;

bool IsTumFolder(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(fs::path(path) / "rgb.txt", error);
}

void ReadTumLists(const fs::path& folder, ImageList* list) {
  list->name = (folder / "rgb.txt").string();
  list->line_form = "seconds file";
  ReadImageLines([&](std::string_view line, int64_t /*index*/,
                     ListedImage* image) { return ParseSecondsAndFile(line, folder, image); },
                 list);
  ReadTruthLines((folder / "groundtruth.txt").string(), ParseTumLine, list);
}

std::unique_ptr<ImageSource> OpenTumFolder(const std::string& path, const SourceOptions& options) {
  ImageList list;
  ReadListCamera(path, options, &list);
  ReadTumLists(path, &list);
  return std::make_unique<ImageListSource>(std::move(list), options);
}

}  // namespace vpslam
