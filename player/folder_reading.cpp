#include "player/folder_reading.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "core/base/decode_image.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// Cuts the leading digits off `text`, and gives them without leading zeros.
std::string_view TakeDigits(std::string_view* text) {
  size_t end = 0;
  while (end < text->size() && IsDigit((*text)[end])) ++end;
  std::string_view digits = text->substr(0, end);
  text->remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

bool HasImageEnding(const fs::path& path) {
  constexpr std::array<std::string_view, 9> kEndings = {".png", ".jpg", ".jpeg", ".pgm", ".ppm",
                                                        ".bmp", ".tif", ".tiff", ".webp"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace

void ReadImageLines(const SourceOptions& options,
                    const std::function<std::optional<ListedImage>(std::string_view)>& parse,
                    ImageList* list) {
  const LineCounts counts = ReadLines(list->name, [&](std::string_view line) {
    auto image = parse(line);
    if (image) list->images.push_back(std::move(*image));
    return image.has_value();
  });
  if (counts.refused == 0) return;
  const std::string what = counts.Describe(list->name, list->line_form);
  const BadFrameOptions limits;
  if (list->images.empty() ||
      counts.refused >
          std::max(limits.always_allowed,
                   static_cast<int64_t>(limits.max_fraction * static_cast<double>(counts.lines)))) {
    throw std::runtime_error(what + "; correct the file");
  }
  options.tell(what + ", skipped");
}

void ReadTruthLines(const SourceOptions& options, const std::string& path, const std::string& form,
                    const std::function<std::optional<StampedPose>(std::string_view)>& parse,
                    TruthTrack* truth) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  try {
    const LineCounts counts = ReadLines(path, [&](std::string_view line) {
      const auto pose = parse(line);
      if (pose) truth->Add(pose->first, pose->second);
      return pose.has_value();
    });
    if (counts.refused > 0) options.tell(counts.Describe(path, form) + ", skipped");
  } catch (const std::runtime_error& e) {
    options.tell(e.what());
  }
}

std::optional<SE3> ParseTumPose(std::string_view line) {
  const auto v = TakeNumbers<7>(&line);
  if (!v) return std::nullopt;
  const auto& [x, y, z, qx, qy, qz, qw] = *v;
  const Eigen::Quaterniond q(qw, qx, qy, qz);
  if (q.norm() < 1e-6) return std::nullopt;
  return SE3(q, {x, y, z});
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
  const size_t tries = std::min<size_t>(list.images.size(), BadFrameOptions().max_at_start + 1);
  std::string fault = "is not listed";
  for (size_t i = 0; i < tries; ++i) {
    const DecodedImage image = DecodeGrey(list.images[i].path);
    if (image.fault.empty()) return image.grey.size();
    if (i == 0) fault = image.fault;
  }
  if (tries == 0) throw std::runtime_error(list.name + ": lists no image; is the copy complete?");
  throw std::runtime_error(list.images.front().path + ": " + fault +
                           ", and so are the next ones; " + "is the copy complete?");
}

}  // namespace vpslam
