#include "player/source_factory.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "player/eth3d_folder.h"
#include "player/euroc_folder.h"
#include "player/folder_reading.h"
#include "player/icl_folder.h"
#include "player/image_folder.h"
#include "player/kitti_folder.h"
#include "player/live_camera.h"
#include "player/log_source.h"
#include "player/masked_source.h"
#include "player/seven_scenes_folder.h"
#include "player/sim_source.h"
#include "player/tartanair_folder.h"
#include "player/text_lines.h"
#include "player/tum_folder.h"
#include "player/video_file.h"

namespace vpslam {
namespace {

/// A kind of source: how its name is recognised, and how it is opened.
struct SourceKind {
  const char* name;  ///< for --source
  bool (*recognises)(const std::string& name);
  std::unique_ptr<ImageSource> (*open)(const std::string& name, const SourceOptions& options);
  bool takes_fps = false;   ///< has no time stamps of its own, or need not use them
  bool takes_size = false;  ///< can deliver images of more than one size
};

/// The first that recognises a name is taken, so the order is from the special to the general.
constexpr std::array kSourceKinds = {
    SourceKind{"sim", IsSimulation, OpenSimulation},
    SourceKind{"camera", IsLiveCamera, OpenLiveCamera, true, true},
    SourceKind{"icl", IsIclFolder, OpenIclFolder},
    SourceKind{"eth3d", IsEth3dFolder, OpenEth3dFolder},
    SourceKind{"tum", IsTumFolder, OpenTumFolder},
    SourceKind{"tumvi", IsTumViFolder, OpenTumViFolder},
    SourceKind{"euroc", IsEurocFolder, OpenEurocFolder},
    SourceKind{"kitti", IsKittiFolder, OpenKittiFolder},
    SourceKind{"tartanair", IsTartanAirFolder, OpenTartanAirFolder, true},
    SourceKind{"7scenes", IsSevenScenesFolder, OpenSevenScenesFolder},
    SourceKind{"images", IsImageFolder, OpenImageFolder, true},
    SourceKind{"log", IsMessageLog, OpenMessageLog},
    SourceKind{"video", IsVideoFile, OpenVideoFile, true},
};

namespace fs = std::filesystem;

/// The folder of a sequence in place of the list of its images, which people name as well.
std::string FolderOfList(const std::string& name) {
  std::error_code error;
  const fs::path path(name);
  if (!fs::is_regular_file(path, error)) return name;
  const std::string file = path.filename().string();
  const fs::path folder = fs::absolute(path, error).parent_path();
  if (file == "rgb.txt" && IsTumFolder(folder.string())) return folder.string();
  if (file == "times.txt" && IsKittiFolder(folder.string())) return folder.string();
  if (file == "associations.txt" && IsIclFolder(folder.string())) return folder.string();
  const fs::path mav0 = folder.parent_path();
  if (file == "data.csv" && folder.filename() == "cam0" && IsEurocFolder(mav0.string())) {
    return mav0.string();
  }
  return name;
}

bool BeginsWith(const std::string& path, std::string_view magic) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(magic.size(), '\0');
  return file.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin == magic;
}

/// Why a file is neither log nor video, where that can be told; FFmpeg makes something of almost
/// anything.
std::string WhyNoSequence(const std::string& name) {
  std::error_code error;
  if (fs::file_size(name, error) == 0) return "is empty; is the copy complete?";
  if (IsTextFile(name)) return "is a text file; name the folder of the sequence";
  if (HasImageEnding(name)) return "is a single image; name its folder";
  constexpr const char* kArchive = "is an archive; unpack it, and name the folder";
  constexpr std::pair<std::string_view, const char*> kKinds[] = {
      {"#ROSBAG", "is a bag of ROS; write its images to a folder, and name that"},
      {"SQLite format 3",
       "is a database, as bags of ROS 2 are; write its images to a folder, and name that"},
      {"\x89MCAP", "is an MCAP file; write its images to a folder, and name that"},
      {"PK\x03\x04", kArchive},
      {"\x1F\x8B", kArchive},
      {"7z\xBC\xAF", kArchive},
      {"Rar!", kArchive}};
  for (const auto& [magic, what] : kKinds) {
    if (BeginsWith(name, magic)) return what;
  }
  if (fs::path(name).extension() == ".tar") return kArchive;
  return {};
}

/// What a folder that is no sequence looks like, as a hint; empty if nothing is known.
std::string LooksLike(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder / "mav0" / "cam0", error)) {
    return "mav0/cam0 has no data.csv, the list of its images";
  }
  if (fs::is_directory(folder / "image_0", error) || fs::is_directory(folder / "image_2", error)) {
    return "image_0 or image_2 is there, but no times.txt; name that folder itself to play its "
           "images at --fps";
  }
  if (fs::is_directory(folder / "image_00", error)) {
    return "this is the layout of KITTI's raw data; name image_00/data itself, with --camera and "
           "--fps";
  }
  size_t unknown = 0;
  std::string ending;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error) && !ImageFilesIn(entry.path()).empty()) {
      return entry.path().filename().string() + "/ in it holds images; name that";
    }
    std::string own = entry.path().extension().string();
    std::transform(own.begin(), own.end(), own.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* picture : {".heic", ".heif", ".dng", ".cr2", ".nef", ".arw", ".raw", ".exr",
                                ".gif", ".avif", ".jp2", ".npy"}) {
      if (own != picture) continue;
      ++unknown;
      ending = entry.path().extension().string();
    }
  }
  if (unknown > 0) {
    return fmt::format("it has {} {} files, which are not read; convert them to PNG or JPEG",
                       unknown, ending);
  }
  return {};
}

const SourceKind& Find(const std::string& name, const std::string& forced) {
  for (const SourceKind& kind : kSourceKinds) {
    if (!(forced.empty() ? kind.recognises(name) : forced == kind.name)) continue;
    if (forced.empty() && kind.open == OpenVideoFile) {
      if (const std::string why = WhyNoSequence(name); !why.empty()) {
        throw std::runtime_error(name + ": " + why);
      }
    }
    return kind;
  }
  if (!forced.empty()) {
    std::string names;
    for (const SourceKind& kind : kSourceKinds) names += std::string(" ") + kind.name;
    throw std::runtime_error("--source " + forced + ": there is no such kind; there are" + names);
  }
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw std::runtime_error(
        name + ": does not exist; name the folder of a sequence, a video, camera:0 or sim:room");
  }
  if (const std::string hint = LooksLike(name); !hint.empty()) {
    throw std::runtime_error(name + ": holds no sequence: " + hint);
  }
  throw std::runtime_error(
      name +
      ": holds no sequence: no rgb.txt (TUM RGB-D, ETH3D), *.gt.freiburg (ICL-NUIM), "
      "mav0/cam0/data.csv (EuRoC, TUM-VI), image_0 and times.txt (KITTI), image_left and "
      "pose_left.txt (TartanAir) and no images; name the folder that does");
}

void RequireExisting(const SourceKind& kind, const std::string& name) {
  const bool is_place = !IsSimulation(name) && kind.open != OpenLiveCamera &&
                        !(kind.open == OpenImageFolder && IsImageFolder(name));
  std::error_code error;
  if (is_place && !std::filesystem::exists(name, error)) {
    throw std::runtime_error(name + ": does not exist; check the name");
  }
}

}  // namespace

std::unique_ptr<ImageSource> OpenSource(const std::string& given, const SourceOptions& options) {
  if (const auto why = options.Validate()) throw std::runtime_error(*why);
  const std::string name = FolderOfList(given);
  const SourceKind& kind = Find(name, options.kind);
  RequireExisting(kind, name);
  if (options.fps > 0 && !kind.takes_fps) {
    throw std::runtime_error(name + ": has time stamps of its own; leave out --fps");
  }
  if ((options.width > 0 || options.height > 0) && !kind.takes_size) {
    throw std::runtime_error(name + ": has images of one size; leave out --width and --height");
  }
  auto source = kind.open(name, options);
  if (options.mask_file.empty()) return source;
  return WithMask(std::move(source), options.mask_file);
}

std::vector<std::string> SourceKindNames() {
  std::vector<std::string> names;
  for (const SourceKind& kind : kSourceKinds) names.emplace_back(kind.name);
  return names;
}

}  // namespace vpslam
