// Messages into bytes as LCM lays them out: members one after the other, numbers big-endian, a
// text as its length with the zero byte, its bytes and the zero byte.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/messages/visitor.h"

namespace vpslam {

/// The unsigned integer that has the bits of T.
template <class T>
using WireBits =
    std::conditional_t<sizeof(T) == 1, uint8_t,
                       std::conditional_t<sizeof(T) == 2, uint16_t,
                                          std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>>>;

class WireWriter : public Visitor<WireWriter> {
 public:
  template <class T>
  void Put(T scalar) {
    auto bits = std::bit_cast<WireBits<T>>(scalar);
    std::array<uint8_t, sizeof(T)> big_endian;
    for (std::size_t i = sizeof(T); i-- > 0; bits = static_cast<WireBits<T>>(bits >> 7 >> 1)) {
      big_endian[i] = static_cast<uint8_t>(bits);
    }
    std::copy(big_endian.begin(), big_endian.end(), Room(sizeof(T)));
  }

  template <class T, class R>
  void Leaf(const char*, T& value, R) {
    if constexpr (requires { value.c_str(); }) {
      Put(static_cast<int32_t>(value.size() + 1));
      std::copy_n(value.c_str(), value.size() + 1, Room(value.size() + 1));
    } else {
      ForEachScalar(value, [this](const auto& scalar) { Put(scalar); });
    }
  }
  template <class T, class R = AnyValue>
  void Array(const char* length, const char* name, T& vector, R rule = {}) {
    if constexpr (sizeof(typename T::value_type) == 1) {
      std::copy(vector.begin(), vector.end(), Room(vector.size()));
    } else {
      Visitor::Array(length, name, vector, rule);
    }
  }
  template <class T>
  void SizeOf(const char*, T& vector) {
    Put(static_cast<int32_t>(vector.size()));
  }
  template <class P, class T, class F>
  void Optional(const char*, P& pointer, const T& otherwise, F&& describe) {
    Put(static_cast<bool>(pointer));
    describe(*this, pointer ? *pointer : otherwise);
  }

  std::vector<uint8_t> Take() {
    bytes_.resize(used_);
    return std::move(bytes_);
  }

 private:
  // A vector that grows with each scalar takes three times as long.
  uint8_t* Room(std::size_t size) {
    if (bytes_.size() < used_ + size) bytes_.resize(2 * (used_ + size));
    used_ += size;
    return bytes_.data() + used_ - size;
  }

  std::vector<uint8_t> bytes_;
  std::size_t used_ = 0;
};

}  // namespace vpslam
