#include "player/simulator/spec.h"

#include <charconv>
#include <set>
#include <stdexcept>
#include <string_view>

namespace vpslam::simulator {
namespace {

constexpr const char* kExample =
    "write for example sim:room?seed=1&frames=600&noise=1&distortion=0";

[[noreturn]] void Fail(const std::string& text, const std::string& why) {
  throw std::runtime_error(text + ": " + why + "; " + kExample);
}

/// A number in [low, high].
template <class T>
T Number(const std::string& text, std::string_view key, std::string_view value, T low, T high) {
  T number{};
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size() || !(number >= low) ||
      !(number <= high)) {
    std::string range = std::to_string(low) + " to " + std::to_string(high);
    if constexpr (std::is_floating_point_v<T>) {
      range =
          std::to_string(static_cast<int>(low)) + " to " + std::to_string(static_cast<int>(high));
    }
    Fail(text, std::string(key) + "='" + std::string(value) + "' is not a number in " + range);
  }
  return number;
}

}  // namespace

Spec ParseSpec(const std::string& text) {
  Spec spec;
  std::string_view rest = text;
  if (!rest.starts_with("sim:")) Fail(text, "a simulated source starts with 'sim:'");
  rest.remove_prefix(4);
  const size_t question = rest.find('?');
  const std::string_view scene = rest.substr(0, question);
  if (scene == "room") {
    spec.scene = SceneKind::kRoom;
  } else if (scene == "corridor") {
    spec.scene = SceneKind::kCorridor;
  } else {
    Fail(text, "there is no scene '" + std::string(scene) + "', only room and corridor");
  }
  if (question == std::string_view::npos) return spec;
  rest.remove_prefix(question + 1);

  std::set<std::string_view> seen;
  while (true) {
    const size_t ampersand = rest.find('&');
    const std::string_view item = rest.substr(0, ampersand);
    const size_t equals = item.find('=');
    if (equals == std::string_view::npos) {
      Fail(text, "'" + std::string(item) + "' is not of the form key=value");
    }
    const std::string_view key = item.substr(0, equals), value = item.substr(equals + 1);
    if (!seen.insert(key).second) Fail(text, std::string(key) + " is given twice");
    if (key == "seed") {
      spec.seed = Number<uint64_t>(text, key, value, 0, 1'000'000'000);
    } else if (key == "frames") {
      spec.frames = Number<int>(text, key, value, 1, 100'000);
    } else if (key == "noise") {
      spec.noise = Number<double>(text, key, value, 0, 20);
    } else if (key == "distortion") {
      spec.distortion = Number<int>(text, key, value, 0, 1) != 0;
    } else {
      Fail(text, "there is no key '" + std::string(key) + "'");
    }
    if (ampersand == std::string_view::npos) return spec;
    rest.remove_prefix(ampersand + 1);
  }
}

}  // namespace vpslam::simulator
