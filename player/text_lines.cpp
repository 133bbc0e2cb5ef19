#include "player/text_lines.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

namespace vpslam {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kSeparators = " \t\r,";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
/// The largest number of seconds that is taken for one: the year 2255.
constexpr double kMaxSeconds = 9e9;
/// The smallest number that is taken for milliseconds since 1970: the year 1973.
constexpr double kMinEpochMilliseconds = 1e11;

std::string ReadText(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, error)) {
    throw std::runtime_error(path + ": cannot be read; check its permissions");
  }
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const bool utf16 = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
  if (utf16 || text.find('\0') != std::string::npos) {
    throw std::runtime_error(
        path + (utf16 ? ": is UTF-16; save it as UTF-8" : ": is no text, as it holds zero bytes"));
  }
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

/// Cuts the first line off `text`; lines end as on Unix, Windows or an old Macintosh.
std::string_view TakeLine(std::string_view* text) {
  const std::string_view line = text->substr(0, text->find_first_of("\r\n"));
  const bool two = text->substr(line.size()).starts_with("\r\n");
  text->remove_prefix(std::min(line.size() + (two ? 2 : 1), text->size()));
  return line;
}

bool BeginsWithALetter(std::string_view line) {
  const std::string_view word = TakeWord(&line);
  return !word.empty() && std::isalpha(static_cast<unsigned char>(word.front())) != 0;
}

/// True for UTF-8 without control characters; its last character may be cut.
bool IsUtf8Text(std::string_view bytes) {
  size_t following = 0;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (following > 0) {
      if ((byte & 0xC0) != 0x80) return false;
      --following;
    } else if (byte >= 0x80) {
      following = byte >= 0xF0 ? 3 : byte >= 0xE0 ? 2 : 1;
      if (byte < 0xC2 || byte > 0xF4) return false;
    } else if ((byte < ' ' && std::string_view("\t\n\r\f").find(c) == std::string_view::npos) ||
               byte == 0x7F) {
      return false;
    }
  }
  return !bytes.empty();
}

/// Of time since 1970; empty where the number is none in a finer unit than seconds.
std::string_view FinerUnit(double value) {
  if (std::abs(value) < kMinEpochMilliseconds) return {};
  if (std::abs(value) < 1e3 * kMinEpochMilliseconds) return "milliseconds";
  if (std::abs(value) < 1e6 * kMinEpochMilliseconds) return "microseconds";
  return "nanoseconds";
}

}  // namespace

std::string_view Trim(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

std::string_view TakeWord(std::string_view* line) {
  line->remove_prefix(std::min(line->find_first_not_of(kSeparators), line->size()));
  if (line->starts_with('"') && line->find('"', 1) != std::string_view::npos) {
    const std::string_view word = line->substr(1, line->find('"', 1) - 1);
    line->remove_prefix(word.size() + 2);
    return word;
  }
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

size_t CountWords(std::string_view line) {
  size_t words = 0;
  while (!TakeWord(&line).empty()) ++words;
  return words;
}

std::optional<int64_t> ParseStamp_us(std::string_view text) {
  // A double holds microseconds exactly enough for 285 years since 1970.
  const auto seconds = ParseNumber(text);
  if (!seconds || std::abs(*seconds) > kMaxSeconds) return std::nullopt;
  return std::llround(*seconds * 1e6);
}

std::optional<int64_t> ParseNanoseconds_us(std::string_view text) {
  if (const size_t point = text.find('.');
      point != std::string_view::npos && text.find_first_not_of('0', point + 1) == text.npos) {
    text = text.substr(0, point);
  }
  int64_t value = 0;  // a double would lose the last digits of today's nanoseconds
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  if (end != text.data() + text.size()) {
    // An exponent: whoever wrote it had a double, which is good to 0.3 us.
    const auto number = ParseNumber(text);
    if (text.find_first_of("eE") == text.npos || !number || *number > 9e18) return std::nullopt;
    value = std::llround(*number);
  }
  if (value < 0) return std::nullopt;
  return value / 1000 + (value % 1000 >= 500 ? 1 : 0);
}

std::string FaultOfSeconds(std::string_view text) {
  const auto value = ParseNumber(text);
  if (!value) return fmt::format("'{}' is no number of seconds", text);
  if (const std::string_view unit = FinerUnit(*value); !unit.empty()) {
    return fmt::format("has the time stamp {} in {}; write seconds", text, unit);
  }
  if (!ParseStamp_us(text)) return fmt::format("has the time stamp {}, no time in seconds", text);
  return {};
}

std::string FaultOfNanoseconds(std::string_view text) {
  if (ParseNanoseconds_us(text)) return {};
  const auto value = ParseNumber(text);
  if (value && *value > 0 && *value < kMaxSeconds) {
    return fmt::format("has the time stamp {} in seconds; write whole nanoseconds", text);
  }
  return fmt::format("'{}' is no whole number of nanoseconds", text);
}

std::string NotOfTheForm(const std::string& form) {
  return fmt::format("is not of the form '{}'", form);
}

std::string LineCounts::Describe(const std::string& path) const {
  return fmt::format("{}:{}: {}; so are {} of {} lines", path, first_refused_number, first_fault,
                     refused, lines);
}

LineCounts ReadLines(const std::string& path, const LineUse& use) {
  const std::string content = ReadText(path);
  LineCounts counts;
  int64_t number = 0;
  std::string header_fault;
  int64_t header_number = 0;
  for (std::string_view text = content; !text.empty();) {
    ++number;
    const std::string_view line = Trim(TakeLine(&text));
    if (line.empty() || line.front() == '#') continue;
    std::string fault = use(line, {number, counts.lines});
    if (counts.lines == 0 && header_number == 0 && !fault.empty() && BeginsWithALetter(line)) {
      header_fault = std::move(fault);
      header_number = number;
      continue;
    }
    ++counts.lines;
    if (!fault.empty() && ++counts.refused == 1) {
      counts.first_refused_number = number;
      counts.first_fault = std::move(fault);
    }
  }
  // Where nothing good follows, the first line was no header but the first of the faults.
  if (header_number > 0 && counts.refused == counts.lines) {
    ++counts.lines;
    ++counts.refused;
    counts.first_refused_number = header_number;
    counts.first_fault = std::move(header_fault);
  }
  return counts;
}

bool IsTextFile(const std::string& path) {
  constexpr std::array<std::string_view, 8> kEndings = {".txt", ".csv",  ".yaml", ".yml",
                                                        ".md",  ".json", ".xml",  ".log"};
  const std::string ending = std::filesystem::path(path).extension().string();
  if (std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end()) return true;
  std::ifstream file(path, std::ios::binary);
  std::string begin(4096, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<size_t>(file.gcount()));
  if (begin.starts_with("YUV4MPEG2")) return false;  // a video with a line of text before it
  return IsUtf8Text(begin);
}

}  // namespace vpslam
