#include "core/messages/names.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace vpslam {
namespace {

bool IsNameCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.';
}

}  // namespace

bool IsProcessName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxNameLength &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

bool IsImageSegmentName(const std::string& name) {
  constexpr std::string_view kPrefix = "/vpslam-";
  return name.size() > kPrefix.size() && name.size() <= kMaxNameLength &&
         name.compare(0, kPrefix.size(), kPrefix) == 0 &&
         std::all_of(name.begin() + kPrefix.size(), name.end(), IsNameCharacter);
}

}  // namespace vpslam
