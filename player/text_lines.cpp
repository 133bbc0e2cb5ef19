#include "player/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

namespace vpslam {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kSeparators = " \t\r,";

}  // namespace

std::string_view Trim(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

std::string_view TakeWord(std::string_view* line) {
  line->remove_prefix(std::min(line->find_first_not_of(kSeparators), line->size()));
  const std::string_view word = line->substr(0, line->find_first_of(kSeparators));
  line->remove_prefix(std::min(word.size() + 1, line->size()));
  return word;
}

std::optional<double> ParseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<int64_t> ParseStamp_us(std::string_view text) {
  // A double holds microseconds exactly enough for 285 years since 1970.
  const auto seconds = ParseNumber(text);
  if (!seconds || std::abs(*seconds) > 9e9) return std::nullopt;
  return std::llround(*seconds * 1e6);
}

std::optional<int64_t> ParseNanoseconds_us(std::string_view text) {
  int64_t value = 0;  // a double would lose the last digits of today's nanoseconds
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value / 1000 + (value % 1000 >= 500 ? 1 : 0);
}

std::string LineCounts::Describe(const std::string& path, const std::string& form) const {
  return fmt::format("{}:{}: is not of the form '{}'; so are {} of {} lines", path,
                     first_refused_number, form, refused, lines);
}

LineCounts ReadLines(const std::string& path, const std::function<bool(std::string_view)>& use) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read; check its permissions");
  LineCounts counts;
  int64_t number = 0;
  for (std::string text; std::getline(file, text);) {
    ++number;
    const std::string_view line = Trim(text);
    if (line.empty() || line.front() == '#') continue;
    ++counts.lines;
    if (!use(line) && ++counts.refused == 1) counts.first_refused_number = number;
  }
  return counts;
}

}  // namespace vpslam
