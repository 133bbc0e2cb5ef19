// What visitors of descriptions have in common.
#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/base/description.h"

namespace vpslam {

/// Walks through the members of a described struct down to the leaves, for each of which it calls
/// Self::Leaf(name, value, rule). Self redefines what it does otherwise.
template <class Self>
class Visitor {
 public:
  template <class T, class R = AnyValue>
  void operator()(const char* name, T& value, R rule = {}) {
    if constexpr (Described<T>) {
      self().Nested(name, value, Description<std::remove_const_t<T>>());
    } else {
      self().Leaf(name, value, rule);
    }
  }
  template <class T, class Part>
  void Nested(const char*, T& value, Part) {
    Part::Visit(self(), value);
  }
  template <class T, class R = AnyValue>
  void Array(const char*, const char* name, T& vector, R rule = {}) {
    for (auto& element : vector) self()(name, element, rule);
  }
  template <class T>
  void SizeOf(const char*, T&) {}
  template <class T, class Member>
  void Pool(const char* length, const char* name, T& owners, Member member) {
    for (auto& owner : owners) self().Array(length, name, owner.*member);
  }
  template <class P, class T, class F>
  void Optional(const char*, P& pointer, const T&, F&& describe) {
    if (pointer) describe(self(), *pointer);
  }

 private:
  Self& self() { return static_cast<Self&>(*this); }
};

/// Sets what Optional describes.
template <class T>
void SetOptional(std::optional<T>* to, T value) {
  *to = std::move(value);
}
template <class T>
void SetOptional(std::shared_ptr<const T>* to, T value) {
  *to = std::make_shared<const T>(std::move(value));
}

}  // namespace vpslam
