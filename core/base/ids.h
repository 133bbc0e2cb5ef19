// Typed ids: a KeyframeId cannot be passed where a PointId is meant.
//
// Valid ids are >= 0 and are given once, in increasing order, by one owner: keyframe and map ids by
// the frontend, point and line ids by the backend. They are never used again after an erasure.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace vpslam {

template <class Tag>
struct TypedId {
  int32_t value = -1;

  TypedId() = default;
  constexpr explicit TypedId(int32_t v) : value(v) {}
  constexpr bool IsValid() const { return value >= 0; }
  auto operator<=>(const TypedId&) const = default;
};

using KeyframeId = TypedId<struct KeyframeTag>;
using PointId = TypedId<struct PointTag>;
using LineId = TypedId<struct LineTag>;
using MapId = TypedId<struct MapTag>;

}  // namespace vpslam

template <class Tag>
struct std::hash<vpslam::TypedId<Tag>> {
  std::size_t operator()(const vpslam::TypedId<Tag>& id) const noexcept {
    return std::hash<int32_t>()(id.value);
  }
};
