// How much of a datagram the arrays of a message take, from its description.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages/visitor.h"

namespace vpslam {

/// Adds up the bytes of what has a fixed size.
class FixedSize : public Visitor<FixedSize> {
 public:
  template <class T, class R>
  void Leaf(const char*, T& value, R) {
    static_assert(!std::is_same_v<std::remove_const_t<T>, std::string>,
                  "elements of arrays have a fixed size, which texts have not");
    ForEachScalar(value, [this](const auto& scalar) { bytes_ += sizeof(scalar); });
  }
  template <class T>
  void SizeOf(const char*, T&) {
    bytes_ += sizeof(int32_t);
  }
  template <class P, class T, class F>
  void Optional(const char*, P&, const T& otherwise, F&& describe) {
    bytes_ += sizeof(bool);
    describe(*this, otherwise);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = 0;
};

/// Bytes that an element of an array takes in a datagram.
template <class T>
std::size_t WireBytes() {
  static const std::size_t bytes = [] {
    const T value{};
    FixedSize size;
    size("", value);
    return size.bytes();
  }();
  return bytes;
}

/// One of the lengths that follow the header of a message.
struct ArrayLength {
  std::string_view name;
  int64_t size = 0;           ///< elements of each array that has this length
  int64_t element_bytes = 0;  ///< bytes in the datagram per element, of all of them together
};

/// Collects the lengths of a message's arrays in the order in which they travel.
class ArrayLengths : public Visitor<ArrayLengths> {
 public:
  template <class T, class R>
  void Leaf(const char*, T&, R) {}
  template <class T, class R = AnyValue>
  void Array(std::string_view length, const char* name, T& vector, R = {}) {
    Add(length, name, std::ssize(vector), WireBytes<typename T::value_type>());
  }
  template <class T, class Member>
  void Pool(std::string_view length, const char* name, T& owners, Member member) {
    int64_t size = 0;
    for (const auto& owner : owners) size += std::ssize(owner.*member);
    using Owner = typename T::value_type;
    using Vector = std::remove_cvref_t<decltype(std::declval<Owner>().*member)>;
    Add(length, name, size, WireBytes<typename Vector::value_type>());
  }
  template <class P, class T, class F>
  void Optional(const char*, P& pointer, const T& otherwise, F&& describe) {
    const T& value = pointer ? *pointer : otherwise;
    describe(*this, value);
  }

  const std::vector<ArrayLength>& lengths() const { return lengths_; }
  /// Name of an array that is not as long as its length says; nullptr if there is none.
  const char* misfit() const { return misfit_; }

 private:
  void Add(std::string_view length, const char* name, int64_t size, std::size_t element_bytes) {
    const auto known = std::find_if(lengths_.begin(), lengths_.end(),
                                    [&](const ArrayLength& l) { return l.name == length; });
    if (known == lengths_.end()) {
      lengths_.push_back({length, size, static_cast<int64_t>(element_bytes)});
    } else {
      if (known->size != size) misfit_ = name;
      known->element_bytes += static_cast<int64_t>(element_bytes);
    }
  }

  std::vector<ArrayLength> lengths_;
  const char* misfit_ = nullptr;
};

template <class T>
ArrayLengths CollectArrayLengths(const T& message) {
  ArrayLengths lengths;
  Description<T>::Visit(lengths, message);
  return lengths;
}

}  // namespace vpslam
