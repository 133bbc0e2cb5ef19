#include "player/source_factory.h"

#include <array>
#include <filesystem>
#include <stdexcept>

#include "player/sim_source.h"
#include "player/tum_folder.h"

namespace vpslam {
namespace {

/// A kind of source: how its name is recognised, and how it is opened. The first that fits is
/// taken.
struct SourceKind {
  bool (*recognises)(const std::string& name);
  std::unique_ptr<ImageSource> (*open)(const std::string& name, const SourceOptions& options);
};

constexpr std::array kSourceKinds = {SourceKind{IsSimulation, OpenSimulation},
                                     SourceKind{IsTumFolder, OpenTumFolder}};

}  // namespace

std::unique_ptr<ImageSource> OpenSource(const std::string& name, const SourceOptions& options) {
  if (const auto why = options.Validate()) throw std::runtime_error(*why);
  for (const SourceKind& kind : kSourceKinds) {
    if (kind.recognises(name)) return kind.open(name, options);
  }
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw std::runtime_error(name + ": does not exist; name the folder of a sequence, or sim:room");
  }
  throw std::runtime_error(name +
                           ": holds no rgb.txt; name a folder in the layout of the TUM RGB-D "
                           "benchmark (rgb.txt, camera.yaml)");
}

}  // namespace vpslam
