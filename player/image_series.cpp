#include "player/image_series.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace vpslam {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// A name with * for each number, and the numbers, without leading zeros.
std::pair<std::string, std::string> PatternAndNumbers(const std::string& name) {
  std::string pattern, numbers;
  for (size_t i = 0; i < name.size();) {
    if (!IsDigit(name[i])) {
      pattern += name[i++];
      continue;
    }
    while (i < name.size() && name[i] == '0') ++i;
    while (i < name.size() && IsDigit(name[i])) numbers += name[i++];
    pattern += '*';
    numbers += ' ';
  }
  return {pattern, numbers};
}

/// Whole words of a name that say what it is a picture of.
bool NamesACompanion(const std::string& pattern) {
  constexpr std::array<std::string_view, 16> kWords = {
      "depth", "mask",      "masks",  "seg",     "label",      "labels", "semantic", "instance",
      "disp",  "disparity", "normal", "normals", "confidence", "flow",   "ir",       "infrared"};
  std::string word;
  for (const char c : pattern + ".") {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    if (std::find(kWords.begin(), kWords.end(), word) != kWords.end()) return true;
    word.clear();
  }
  return false;
}

}  // namespace

std::vector<ImageSeries> ParallelSeries(const std::vector<std::string>& names) {
  constexpr size_t kMinImages = 2;
  std::map<std::string, ImageSeries> by_pattern;
  std::map<std::string, std::set<std::string>> numbers_of;
  for (size_t i = 0; i < names.size(); ++i) {
    const auto [pattern, numbers] = PatternAndNumbers(names[i]);
    ImageSeries& series = by_pattern[pattern];
    series.pattern = pattern;
    series.images.push_back(i);
    numbers_of[pattern].insert(numbers);
  }
  std::set<std::string> parallel;
  for (const auto& [a, numbers] : numbers_of) {
    for (const auto& [b, others] : numbers_of) {
      if (a == b || numbers.size() < kMinImages || numbers.size() > others.size()) continue;
      const auto shared = std::count_if(numbers.begin(), numbers.end(), [&](const auto& number) {
        return others.contains(number);
      });
      if (2 * static_cast<size_t>(shared) > numbers.size()) parallel.insert({a, b});
    }
  }
  std::vector<ImageSeries> result;
  for (auto& [pattern, series] : by_pattern) {
    if (!parallel.contains(pattern)) continue;
    series.is_companion = NamesACompanion(pattern);
    result.push_back(std::move(series));
  }
  return result;
}

bool MatchesSeries(const std::string& name, const std::string& pattern) {
  return PatternAndNumbers(name).first == pattern;
}

std::string DescribeSeries(const std::vector<ImageSeries>& series) {
  std::string text;
  for (size_t i = 0; i < series.size(); ++i) {
    if (i > 0) text += i + 1 == series.size() ? " and " : ", ";
    text += fmt::format("{} ({} images)", series[i].pattern, series[i].images.size());
  }
  return text;
}

}  // namespace vpslam
