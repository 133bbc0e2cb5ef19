// Lines, words and numbers of the text files that data sets come with, as people write them: with
// or without a byte order mark, a header line, quotes, and line ends of any system.
//
// scripts/vpslam_tools/text_lines.py reads them in the same way; tests/unit/odd_files.json is a
// table of odd ones that the tests of both go through.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace vpslam {

std::string_view Trim(std::string_view text);

/// Cuts the first word off `line`. Words end at blanks, and in CSV files at commas; quotes around a
/// word are taken off.
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

/// How many words there are.
size_t CountWords(std::string_view line);

/// Decimal seconds to microseconds, rounded; nullopt if `text` is no finite number of seconds.
std::optional<int64_t> ParseStamp_us(std::string_view text);

/// Whole nanoseconds to microseconds, rounded; nullopt if `text` is no whole number. Zeros behind a
/// point, and an exponent, are what other programs make of one: 1403636579763555584.0, 1.4e+18.
std::optional<int64_t> ParseNanoseconds_us(std::string_view text);

/// What is wrong with a time stamp that ought to be in seconds, or in nanoseconds, as the end of a
/// sentence that begins with the place; empty if nothing is.
std::string FaultOfSeconds(std::string_view text);
std::string FaultOfNanoseconds(std::string_view text);

struct LineCounts {
  int64_t lines = 0;    ///< without comments, empty ones and a header
  int64_t refused = 0;  ///< of them
  int64_t first_refused_number = 0;
  std::string first_fault;

  /// "FILE:7: is not of the form 'seconds file'; so are 2 of 90 lines"
  std::string Describe(const std::string& path) const;
};

/// Where a line stands.
struct LinePlace {
  int64_t number = 1;  ///< in the file, from 1 on, as editors show it
  int64_t index = 0;   ///< from 0 on, without comments, empty lines and a header
};

/// What is wrong with a line, as `is not of the form ...`; empty if nothing is.
using LineUse = std::function<std::string(std::string_view line, const LinePlace& place)>;

/// "is not of the form 'FORM'"
std::string NotOfTheForm(const std::string& form);

/// Calls `use` with each line that is neither empty nor a comment (#). A first line that is refused
/// and begins with a letter is a header and does not count, unless it is all that there is. Throws
/// std::runtime_error if the file cannot be read or is not text of single bytes.
LineCounts ReadLines(const std::string& path, const LineUse& use);

/// True for a file that is text, by its ending or by what it begins with.
bool IsTextFile(const std::string& path);

}  // namespace vpslam
