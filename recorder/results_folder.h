// A folder whose files are whole at any time: each is written under another name, then renamed.
#pragma once

#include <map>
#include <string>

namespace vpslam {

class ResultsFolder {
 public:
  /// Makes the folder and sees whether a file can be written there. Throws std::runtime_error with
  /// one line if not: better before a run than after it.
  explicit ResultsFolder(const std::string& path);

  /// Writes `files`, contents by name, and replaces those of that name. Throws std::runtime_error
  /// with one line if that fails; files that are there already stay as they are.
  void Write(const std::map<std::string, std::string>& files) const;

  /// Removes every trajectory_map*.txt that `files` does not name: left by an earlier state, when
  /// there were more maps.
  void RemoveStaleMaps(const std::map<std::string, std::string>& files) const;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace vpslam
