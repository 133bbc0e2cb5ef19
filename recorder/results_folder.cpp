#include "recorder/results_folder.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

namespace vpslam {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& path, int error) {
  throw std::runtime_error(path + ": cannot be written (" + std::strerror(error) +
                           "); free space, or name another folder with --out");
}

void WriteFile(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) Fail(path, errno);
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const int write_error = errno;
  if (std::fclose(file) != 0 || !written) {
    const int error = written ? errno : write_error;
    std::remove(path.c_str());
    Fail(path, error);
  }
}

std::string TemporaryName(const fs::path& folder, const std::string& name) {
  return (folder / ("." + name + ".tmp")).string();
}

}  // namespace

ResultsFolder::ResultsFolder(const std::string& path) : path_(path) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (!fs::is_directory(path_)) Fail(path_, error ? error.value() : ENOTDIR);
  const std::string probe = TemporaryName(path_, "probe");
  WriteFile(probe, "x");
  std::remove(probe.c_str());
}

void ResultsFolder::Write(const std::map<std::string, std::string>& files) const {
  std::vector<std::string> temporary;
  try {
    for (const auto& [name, text] : files) {
      temporary.push_back(TemporaryName(path_, name));
      WriteFile(temporary.back(), text);
    }
  } catch (...) {
    for (const std::string& path : temporary) std::remove(path.c_str());
    throw;
  }
  for (const auto& [name, text] : files) {
    const std::string path = (fs::path(path_) / name).string();
    if (std::rename(TemporaryName(path_, name).c_str(), path.c_str()) != 0) Fail(path, errno);
  }
}

void ResultsFolder::RemoveStaleMaps(const std::map<std::string, std::string>& files) const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("trajectory_map") && name.ends_with(".txt") && !files.contains(name)) {
      fs::remove(entry.path(), error);
    }
  }
}

}  // namespace vpslam
