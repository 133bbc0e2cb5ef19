// The way back of wire_writer.h, from bytes that anyone may have sent.
//
// Lengths of arrays stand before all arrays. They are checked against the size of the datagram
// before anything is allocated, so that no message takes more than a small multiple of its size.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/messages/array_lengths.h"
#include "core/messages/visitor.h"
#include "core/transport/wire_writer.h"

namespace vpslam {

class WireReader : public Visitor<WireReader> {
 public:
  explicit WireReader(std::span<const uint8_t> bytes) : rest_(bytes) {}

  /// nullptr while all is well; after a fault, values that are read are of no meaning.
  const char* fault() const { return fault_; }
  /// Is this all that was sent?
  bool AtEnd() const { return rest_.empty(); }

  template <class T>
  T Get() {
    if (fault_ || rest_.size() < sizeof(T)) {
      Fail("truncated");
      return T{};
    }
    WireBits<T> bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits = static_cast<WireBits<T>>(static_cast<uint64_t>(bits) << 8 | rest_[i]);
    }
    rest_ = rest_.subspan(sizeof(T));
    if constexpr (std::is_same_v<T, bool>)
      return bits != 0;
    else
      return std::bit_cast<T>(bits);
  }

  /// Reads the lengths of the arrays of a message of type T.
  template <class T>
  void ReadLengths() {
    lengths_ = CollectArrayLengths(T()).lengths();
    int64_t needed = 0;
    for (ArrayLength& length : lengths_) {
      length.size = Get<int32_t>();
      if (length.size < 0) return Fail("negative length of an array");
      needed += length.size * length.element_bytes;
    }
    if (needed > std::ssize(rest_)) Fail("an array is longer than the message");
  }

  template <class T, class R>
  void Leaf(const char*, T& value, R) {
    if constexpr (std::is_same_v<T, std::string>) {
      ReadText(&value);
    } else {
      ForEachScalar(value,
                    [this](auto& scalar) { scalar = Get<std::decay_t<decltype(scalar)>>(); });
    }
  }
  template <class T, class R = AnyValue>
  void Array(std::string_view length, const char* name, T& vector, R = {}) {
    if (fault_) return;
    vector.resize(SizeOfArray(length));
    ReadElements(name, &vector);
  }
  template <class T>
  void SizeOf(const char*, T& vector) {
    const auto size = Get<int32_t>();
    promised_ += size * static_cast<int64_t>(WireBytes<typename T::value_type>());
    if (size < 0 || promised_ > std::ssize(rest_)) return Fail("more promised than sent");
    vector.resize(size);
  }
  template <class T, class Member>
  void Pool(std::string_view length, const char* name, T& owners, Member member) {
    std::size_t size = 0;
    for (auto& owner : owners) size += (owner.*member).size();
    if (size != SizeOfArray(length)) return Fail("an array whose owners say otherwise");
    for (auto& owner : owners) ReadElements(name, &(owner.*member));
  }
  template <class P, class T, class F>
  void Optional(const char*, P& pointer, const T& otherwise, F&& describe) {
    const bool exists = Get<bool>();
    T value = otherwise;
    describe(*this, value);
    if (exists) return SetOptional(&pointer, std::move(value));
    ArrayLengths arrays;
    describe(arrays, value);
    for (const ArrayLength& length : arrays.lengths()) {
      if (length.size != 0) Fail("an array of what is not there");
    }
  }

 private:
  void Fail(const char* why) {
    if (!fault_) fault_ = why;
  }

  std::size_t SizeOfArray(std::string_view length) const {
    for (const ArrayLength& l : lengths_) {
      if (l.name == length) return static_cast<std::size_t>(l.size);
    }
    return 0;
  }

  template <class T>
  void ReadElements(const char* name, std::vector<T>* vector) {
    if constexpr (sizeof(T) == 1) {
      if (rest_.size() < vector->size()) return Fail("truncated");
      std::copy_n(rest_.begin(), vector->size(), vector->begin());
      rest_ = rest_.subspan(vector->size());
    } else {
      for (T& element : *vector) (*this)(name, element);
    }
  }

  void ReadText(std::string* text) {
    const auto size = Get<int32_t>();  // with the zero byte
    if (fault_ || size < 1 || size > std::ssize(rest_) || rest_[size - 1] != 0) {
      return Fail("a text of impossible length");
    }
    text->assign(rest_.begin(), rest_.begin() + size - 1);
    rest_ = rest_.subspan(size);
  }

  std::span<const uint8_t> rest_;
  std::vector<ArrayLength> lengths_;
  int64_t promised_ = 0;  ///< bytes of lists that are still to come
  const char* fault_ = nullptr;
};

}  // namespace vpslam
