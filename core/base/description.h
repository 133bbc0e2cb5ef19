// How a struct is described, once.
//
// A described struct lists its members in the order in which they travel, each with the name that
// it has in lcmtypes/ and the rule that a sound value keeps:
//
//   struct Sighting {
//     PointId point;
//     int32_t found = 0;
//
//     static constexpr const char* kWireName = "sighting_t";
//     static void Describe(auto& v, auto& m) {
//       auto& [point, found] = m;  // does not compile if a member is forgotten
//       v("point", point, Required());
//       v("found", found, kNotNegative);
//     }
//     std::optional<std::string> Validate() const;  // optional: rules between members
//   };
//
// `m` is the struct, const or not, and `v` a visitor: it encodes, decodes, validates, counts bytes,
// computes LCM's fingerprint, or draws random values. What a visitor offers:
//
//   v(name, member, rule)             a number, id, enumeration, text, vector, matrix, rotation, or
//                                     a described struct
//   v.Nested(name, value, Part())     the members of `value` that Part describes, as a struct
//   v.Array(length, name, vector, rule)  elements of fixed size; arrays that name the same `length`
//                                     have the same one
//   v.SizeOf(name, vector), and in the struct that holds the vector `all` of such structs
//   v.Pool(length, name, all, &Struct::vector)  a list for each struct, sent as one array
//   v.Optional(flag, pointer, otherwise, describe)  what may be missing: a flag, and the members
//                                     that `describe(v, value)` lists, of `otherwise` if missing
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/ids.h"
#include "core/geometry/se3.h"

namespace vpslam {

// Rules. Without one an integer may be anything, an id none, and a real number must be finite. A
// rotation must be a unit quaternion in any case.

struct AnyValue {};
/// Integers, ends included.
struct Between {
  int64_t low, high;
};
/// Real numbers, alone or in a vector; ends included, so no NaN.
struct Within {
  double low, high;
};
/// Milliseconds, or NaN for a stage that did not run. Rounding makes slightly negative ones.
struct Duration {};
/// A vector of length 1.
struct UnitLength {};
/// An id that is not "none".
struct Required {};
/// These enumerators and no others.
template <auto... values>
struct OneOf {};
/// Letters, digits, '-', '_' or '.'; 1 to kMaxNameLength of them.
struct ProcessName {
  bool may_be_empty = false;
};
/// Any text without a zero byte.
struct Text {
  std::size_t max_length;
};

inline constexpr Between kNotNegative{0, std::numeric_limits<int64_t>::max()};
inline constexpr Between kIndexOrNone{-1, std::numeric_limits<int64_t>::max()};
inline constexpr double kMaxLength = 1e12;  ///< map units
inline constexpr Within kLength{0, kMaxLength};
inline constexpr Within kCoordinate{-kMaxLength, kMaxLength};
inline constexpr Within kPixel{-1e6, 1e6};        ///< may lie far outside the image
inline constexpr double kUnitTolerance = 1e-3;    ///< of norms
inline constexpr int32_t kMaxElements = 1 << 16;  ///< of an array, except for arrays of bytes
inline constexpr Between kFeatureIndex{0, kMaxElements - 1};

/// Description<T>::kWireName and Description<T>::Visit(visitor, value).
template <class T>
struct Description;

template <class T>
requires requires { T::kWireName; }
struct Description<T> {
  static constexpr const char* kWireName = T::kWireName;
  static void Visit(auto& v, auto& m) { T::Describe(v, m); }
};

template <>
struct Description<SE3> {
  static constexpr const char* kWireName = "se3_t";
  static void Visit(auto& v, auto& m) {
    v("rotation", m.rotation);
    v("translation", m.translation, kCoordinate);
  }
};

/// The descriptor of a feature.
template <>
struct Description<std::array<uint64_t, 4>> {
  static constexpr const char* kWireName = "descriptor_t";
  static void Visit(auto& v, auto& m) {
    auto words = std::span(m);
    v("words", words);
  }
};

template <class T>
concept Described = requires {
  sizeof(Description<std::remove_const_t<T>>);
};

template <class T>
concept IsRotation = std::same_as<std::remove_const_t<T>, Eigen::Quaterniond>;
template <class T>
concept IsMatrix = std::derived_from<T, Eigen::MatrixBase<std::remove_const_t<T>>>;

/// Calls f(scalar) for each number of a leaf in the order in which they travel: rotations as w, x,
/// y, z, matrices row by row, ids as int64_t, enumerations as int32_t. f may change them if T is
/// not const.
template <class T, class F>
void ForEachScalar(T& value, F&& f) {
  using Value = std::remove_const_t<T>;
  if constexpr (IsRotation<T>) {
    f(value.w()), f(value.x()), f(value.y()), f(value.z());
  } else if constexpr (IsMatrix<T>) {
    for (int i = 0; i < value.rows(); ++i) {
      for (int j = 0; j < value.cols(); ++j) f(value(i, j));
    }
  } else if constexpr (std::is_enum_v<Value>) {
    auto number = static_cast<std::underlying_type_t<Value>>(value);
    f(number);
    if constexpr (!std::is_const_v<T>) value = static_cast<Value>(number);
  } else if constexpr (requires { value.IsValid(); }) {
    f(value.value);
  } else if constexpr (requires { value.size(); }) {
    for (auto& element : value) f(element);
  } else {
    f(value);
  }
}

}  // namespace vpslam
