// LCM's fingerprint of a message type, from its description: a hash of the names, types and
// dimensions of all members, of the structs within it, too. Equal to lcm-gen's getHash() exactly
// where lcmtypes/ declares the same members in the same order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/messages/array_lengths.h"
#include "core/messages/visitor.h"

namespace vpslam {

class FingerprintHash : public Visitor<FingerprintHash> {
 public:
  template <class T, class R>
  void Leaf(std::string_view name, T& value, R) {
    if constexpr (requires { value.c_str(); }) {
      Member(name, "string");
    } else {
      int count = 0;
      std::string_view type;
      ForEachScalar(value, [&](const auto& scalar) {
        ++count;
        type = TypeName(scalar);
      });
      const bool is_array = IsRotation<T> || IsMatrix<T> || requires { value.begin(); };
      is_array ? Member(name, type, kConstant, std::to_string(count)) : Member(name, type);
    }
  }
  template <class T, class Part>
  void Nested(std::string_view name, T& value, Part) {
    AddStruct(value, Part());
    Member(name, {});
  }
  template <class T, class R = AnyValue>
  void Array(std::string_view length, std::string_view name, T&, R = {}) {
    using Element = typename T::value_type;
    const Element element{};
    if constexpr (Described<Element>) {
      AddStruct(element, Description<Element>());
      Member(name, {}, kVariable, length);
    } else {
      ForEachScalar(element,
                    [&](const auto& scalar) { Member(name, TypeName(scalar), kVariable, length); });
    }
  }
  template <class T>
  void SizeOf(std::string_view name, T&) {
    Member(name, "int32_t");
  }
  template <class T, class M>
  void Pool(std::string_view length, std::string_view name, T&, M member) {
    const typename T::value_type owner{};
    Array(length, name, owner.*member);
  }
  template <class P, class T, class F>
  void Optional(std::string_view flag, P&, const T& otherwise, F&& describe) {
    Member(flag, "boolean");
    describe(*this, otherwise);
  }

  /// The members `header` and the lengths of arrays come before those of the message itself.
  template <class Header, class T>
  static int64_t Of() {
    const T message{};
    const Header header{};
    FingerprintHash hash;
    hash("header", header);
    const ArrayLengths lengths = CollectArrayLengths(message);
    for (const ArrayLength& length : lengths.lengths()) hash.Member(length.name, "int32_t");
    Description<T>::Visit(hash, message);
    return static_cast<int64_t>(hash.Finish());
  }

 private:
  enum DimensionMode : char { kConstant = 0, kVariable = 1 };

  void Character(char c) {
    members_ = (members_ << 8 ^ static_cast<uint64_t>(static_cast<int64_t>(members_) >> 55)) +
               static_cast<uint64_t>(static_cast<int64_t>(c));
  }
  void Text(std::string_view text) {
    Character(static_cast<char>(text.size()));
    for (const char c : text) Character(c);
  }
  // Types of structs have no name in the hash: what counts is their members.
  void Member(std::string_view name, std::string_view type) {
    Text(name);
    if (!type.empty()) Text(type);
    Character(0);
  }
  void Member(std::string_view name, std::string_view type, DimensionMode mode,
              std::string_view size) {
    Text(name);
    if (!type.empty()) Text(type);
    Character(1);
    Character(mode);
    Text(size);
  }
  template <class T, class Part>
  void AddStruct(T& value, Part) {
    FingerprintHash hash;
    Part::Visit(hash, value);
    structs_ += hash.Finish();
  }
  uint64_t Finish() const {
    const uint64_t sum = members_ + structs_;
    return sum << 1 | sum >> 63;
  }

  static const char* TypeName(bool) { return "boolean"; }
  static const char* TypeName(uint8_t) { return "byte"; }
  static const char* TypeName(int16_t) { return "int16_t"; }
  static const char* TypeName(int32_t) { return "int32_t"; }
  static const char* TypeName(int64_t) { return "int64_t"; }
  static const char* TypeName(uint64_t) { return "int64_t"; }  // LCM has no unsigned integers
  static const char* TypeName(float) { return "float"; }
  static const char* TypeName(double) { return "double"; }

  uint64_t members_ = 0x12345678;
  uint64_t structs_ = 0;
};

}  // namespace vpslam
