// A folder whose files are whole at any time: each is written under another name, then renamed.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace vpslam {

class ResultsFolder {
 public:
  /// Makes the folder and sees whether a file can be written there. Throws std::runtime_error with
  /// one line if not: better before a run than after it.
  explicit ResultsFolder(const std::string& path);

  /// Writes `files`, name and content, one after the other, and replaces those of that name. Where
  /// one cannot be written, the one that is there already stays as it is, and the others are
  /// written all the same: on a full disk those that stand first, and whatever else still fits.
  /// Then throws std::runtime_error with one line that names those that are missing.
  void Write(const std::vector<std::pair<std::string, std::string>>& files) const;

  /// Removes every trajectory_map*.txt that `files` does not name: left by an earlier state, when
  /// there were more maps.
  void RemoveStaleMaps(const std::map<std::string, std::string>& files) const;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace vpslam
