#include "player/source_factory.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "player/euroc_folder.h"
#include "player/icl_folder.h"
#include "player/image_folder.h"
#include "player/kitti_folder.h"
#include "player/live_camera.h"
#include "player/log_source.h"
#include "player/masked_source.h"
#include "player/sim_source.h"
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
    SourceKind{"tum", IsTumFolder, OpenTumFolder},
    SourceKind{"euroc", IsEurocFolder, OpenEurocFolder},
    SourceKind{"kitti", IsKittiFolder, OpenKittiFolder},
    SourceKind{"images", IsImageFolder, OpenImageFolder, true},
    SourceKind{"log", IsMessageLog, OpenMessageLog},
    SourceKind{"video", IsVideoFile, OpenVideoFile, true},
};

const SourceKind& Find(const std::string& name, const std::string& forced) {
  for (const SourceKind& kind : kSourceKinds) {
    if (forced.empty() ? kind.recognises(name) : forced == kind.name) return kind;
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
  throw std::runtime_error(
      name +
      ": holds no sequence: no rgb.txt (TUM RGB-D), *.gt.freiburg (ICL-NUIM), mav0/cam0/data.csv "
      "(EuRoC), image_0 and times.txt (KITTI) and no images; name the folder that does");
}

void RequireExisting(const SourceKind& kind, const std::string& name) {
  const bool is_place = !IsSimulation(name) && kind.open != OpenLiveCamera;
  std::error_code error;
  if (is_place && !std::filesystem::exists(name, error)) {
    throw std::runtime_error(name + ": does not exist; check the name");
  }
}

}  // namespace

std::unique_ptr<ImageSource> OpenSource(const std::string& name, const SourceOptions& options) {
  if (const auto why = options.Validate()) throw std::runtime_error(*why);
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
