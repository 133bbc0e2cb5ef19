#include "recorder/results_folder.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vpslam {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& path, int error) {
  throw std::runtime_error(path + ": cannot be written (" + std::strerror(error) +
                           "); free space, or name another folder with --out");
}

/// 0, or the error for which there is no such file now.
int WriteFile(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return errno;
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const int write_error = errno;
  if (std::fclose(file) != 0 || !written) {
    const int error = written ? errno : write_error;
    std::remove(path.c_str());
    return error;
  }
  return 0;
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
  if (const int write_error = WriteFile(probe, "x"); write_error != 0) Fail(path_, write_error);
  std::remove(probe.c_str());
}

void ResultsFolder::Write(const std::vector<std::pair<std::string, std::string>>& files) const {
  std::vector<std::string> missing;
  int error = 0;
  for (const auto& [name, text] : files) {
    const std::string temporary = TemporaryName(path_, name);
    int fault = WriteFile(temporary, text);
    const std::string path = (fs::path(path_) / name).string();
    if (fault == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) {
      fault = errno;
      std::remove(temporary.c_str());
    }
    if (fault == 0) continue;
    missing.push_back(name);
    error = fault;
  }
  if (missing.empty()) return;
  throw std::runtime_error(
      fmt::format("{}: cannot write {} ({}){}; free space, or name another folder with --out",
                  path_, fmt::join(missing, ", "), std::strerror(error),
                  missing.size() < files.size() ? "; all other results are there" : ""));
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
