// Lines, words and numbers of the text files that data sets come with.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace vpslam {

std::string_view Trim(std::string_view text);

/// Cuts the first word off `line`. Words end at blanks, and in CSV files at commas.
std::string_view TakeWord(std::string_view* line);

/// nullopt if `word` is no finite number.
std::optional<double> ParseNumber(std::string_view word);

/// The first N words of `line`, which are cut off; nullopt if one is no number.
template <size_t N>
std::optional<std::array<double, N>> TakeNumbers(std::string_view* line) {
  std::array<double, N> numbers;
  for (double& number : numbers) {
    const auto parsed = ParseNumber(TakeWord(line));
    if (!parsed) return std::nullopt;
    number = *parsed;
  }
  return numbers;
}

/// Decimal seconds to microseconds, rounded; nullopt if `text` is no finite number of seconds.
std::optional<int64_t> ParseStamp_us(std::string_view text);

/// Whole nanoseconds to microseconds, rounded; nullopt if `text` is no whole number.
std::optional<int64_t> ParseNanoseconds_us(std::string_view text);

struct LineCounts {
  int64_t lines = 0;    ///< without comments and empty ones
  int64_t refused = 0;  ///< of them
  int64_t first_refused_number = 0;

  /// "FILE:7: is not of the form 'seconds file'; so are 2 of 90 lines"
  std::string Describe(const std::string& path, const std::string& form) const;
};

/// Calls `use` with each line that is neither empty nor a comment (#); it returns false to refuse
/// one. Throws std::runtime_error if the file cannot be read.
LineCounts ReadLines(const std::string& path, const std::function<bool(std::string_view)>& use);

}  // namespace vpslam
