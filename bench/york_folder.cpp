#include "bench/york_folder.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "core/base/camera_file.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void FailAt(const fs::path& file, int line, const std::string& remedy) {
  throw std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + remedy);
}

/// Calls `use(stream, line number)` for each line that is neither empty nor a comment.
template <class Use>
void ForEachLine(const fs::path& path, const Use& use) {
  std::ifstream file(path);
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (text.find_first_not_of(" \t\r") == std::string::npos || text[0] == '#') continue;
    std::istringstream stream(text);
    use(stream, number);
  }
}

}  // namespace

YorkFolder ReadYorkFolder(const std::string& folder) {
  const fs::path root(folder);
  const fs::path truth_file = root / "manhattan.txt", lines_file = root / "lines.txt";
  if (!fs::is_regular_file(truth_file)) {
    throw std::runtime_error(truth_file.string() +
                             ": is missing; name a York-Urban-like folder with --data");
  }
  YorkFolder result;
  result.camera = ReadCameraFile((root / "camera.yaml").string());
  std::map<std::string, size_t> index;
  ForEachLine(truth_file, [&](std::istringstream& in, int line) {
    YorkImage image;
    in >> image.name;
    for (int k = 0; k < 3; ++k) {
      for (int row = 0; row < 3; ++row) in >> image.truth(row, k);
    }
    if (!in || !(image.truth.colwise().norm().minCoeff() > 1e-6)) {
      FailAt(truth_file, line, "write a name and three directions x y z");
    }
    image.truth.colwise().normalize();
    for (const char* extension : {".jpg", ".png", ".JPG", ".PNG"}) {
      const fs::path file = root / "images" / (image.name + extension);
      if (!fs::is_regular_file(file)) continue;
      image.file = file.string();
      break;
    }
    if (image.file.empty()) {
      FailAt(truth_file, line,
             "there is no image " + (root / "images" / image.name).string() + ".jpg or .png");
    }
    index[image.name] = result.images.size();
    result.images.push_back(std::move(image));
  });
  if (result.images.empty()) {
    throw std::runtime_error(truth_file.string() + ": names no image; write one a line");
  }
  ForEachLine(lines_file, [&](std::istringstream& in, int line) {
    std::string name;
    AnnotatedSegment s;
    in >> name >> s.start_px.x() >> s.start_px.y() >> s.end_px.x() >> s.end_px.y() >> s.axis;
    if (!in || s.axis < 0 || s.axis > 2) {
      FailAt(lines_file, line, "write a name, x1 y1 x2 y2 and an axis 0 to 2");
    }
    const auto found = index.find(name);
    if (found != index.end()) result.images[found->second].segments.push_back(s);
    result.has_segments = true;
  });
  return result;
}

}  // namespace vpslam
