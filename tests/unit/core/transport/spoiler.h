// Breaks the rule of one member of a message at a time.
#pragma once

#include <limits>
#include <string>
#include <utility>

#include "core/messages/visitor.h"

namespace vpslam::test {

/// Visits a message and spoils the member number `target` of those that have a rule.
class Spoiler : public Visitor<Spoiler> {
 public:
  explicit Spoiler(int target) : to_go_(target) {}

  template <class T, class R>
  void Leaf(const char* name, T& value, R rule) {
    T bad = value;
    if (spoiled_ || !Spoil(bad, rule) || to_go_-- > 0) return;
    value = bad;
    spoiled_ = name;
  }
  template <class P, class T, class F>
  void Optional(const char*, P& pointer, const T&, F&& describe) {
    if (!pointer) return;
    T value = *pointer;
    describe(*this, value);
    SetOptional(&pointer, std::move(value));
  }

  /// Name of the member that was spoiled; nullptr if there are not so many.
  const char* spoiled() const { return spoiled_; }

 private:
  template <class T>
  static bool Spoil(T& value, AnyValue) {
    bool has_rule = false;
    if constexpr (requires { value.IsValid(); }) {
      value = T(T::kMaxSession, 0);
      has_rule = true;
    } else {
      ForEachScalar(value, [&](auto& scalar) {
        using Scalar = std::decay_t<decltype(scalar)>;
        if constexpr (std::is_floating_point_v<Scalar>) {
          scalar = std::numeric_limits<Scalar>::quiet_NaN();
          has_rule = true;
        }
      });
    }
    return has_rule;
  }
  template <class T>
  static bool Spoil(T& id, Required) {
    id = T(-1);
    return true;
  }
  template <class T>
  static bool Spoil(T& value, Between range) {
    value = static_cast<T>(range.low - 1);
    return true;
  }
  template <class T>
  static bool Spoil(T& value, Within range) {
    ForEachScalar(value, [&](auto& scalar) {
      scalar = static_cast<std::decay_t<decltype(scalar)>>(range.high * 1.01);
    });
    return true;
  }
  static bool Spoil(double& ms, Duration) {
    ms = std::numeric_limits<double>::infinity();
    return true;
  }
  template <class T>
  static bool Spoil(T& vector, UnitLength) {
    vector *= 1.01;
    return true;
  }
  template <class T, auto... values>
  static bool Spoil(T& value, OneOf<values...>) {
    value = static_cast<T>(-1);
    return true;
  }
  static bool Spoil(std::string& name, ProcessName) {
    name = "a b";
    return true;
  }
  static bool Spoil(std::string& text, Text rule) {
    text.assign(rule.max_length + 1, 'a');
    return true;
  }

  int to_go_;
  const char* spoiled_ = nullptr;
};

}  // namespace vpslam::test
