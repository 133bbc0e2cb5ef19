// Typed ids: a KeyframeId cannot be passed where a PointId is meant.
//
// An id is a session and an index in it. A session is one life of one writer: frontends give ids to
// keyframes and maps, the backend to points, lines and Manhattan frames, each in increasing order.
// Who takes over what another has written begins a new session, so that no id is ever given twice.
// Ids of later sessions are greater. They are never used again after an erasure.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace vpslam {

template <class Tag>
struct TypedId {
  static constexpr int kIndexBits = 40;
  // What a sound id keeps below. Tables hold a few bytes for each thousand indices.
  static constexpr int64_t kMaxIndex = int64_t{1} << 32;
  static constexpr int32_t kMaxSession = 1 << 16;

  int64_t value = -1;

  TypedId() = default;
  constexpr explicit TypedId(int64_t v) : value(v) {}
  constexpr TypedId(int32_t session, int64_t index)
      : value((int64_t{session} << kIndexBits) | index) {}
  constexpr bool IsValid() const { return value >= 0; }
  constexpr int32_t session() const { return static_cast<int32_t>(value >> kIndexBits); }
  constexpr int64_t index() const { return value & ((int64_t{1} << kIndexBits) - 1); }
  /// Whether somebody may have given it. "None" is -1 and nothing else.
  constexpr bool IsSound() const {
    return value >= 0 && (value >> kIndexBits) < kMaxSession && index() < kMaxIndex;
  }
  auto operator<=>(const TypedId&) const = default;
};

using KeyframeId = TypedId<struct KeyframeTag>;
using PointId = TypedId<struct PointTag>;
using LineId = TypedId<struct LineTag>;
using MapId = TypedId<struct MapTag>;
using ManhattanId = TypedId<struct ManhattanTag>;

}  // namespace vpslam

template <class Tag>
struct std::hash<vpslam::TypedId<Tag>> {
  std::size_t operator()(const vpslam::TypedId<Tag>& id) const noexcept {
    return std::hash<int64_t>()(id.value);
  }
};
