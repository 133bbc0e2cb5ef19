// What every message must fulfil, sent or received: the rules of its description.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/messages/array_lengths.h"
#include "core/messages/names.h"
#include "core/messages/visitor.h"

namespace vpslam {

/// One reason why a message is not sound, beginning with the place of it.
using Fault = std::optional<std::string>;

/// Visits the members of a message and remembers the first fault.
class Validator : public Visitor<Validator> {
 public:
  template <class T, class R>
  void Leaf(const char* name, T& value, R rule) {
    if (fault_) return;
    if (const char* fault = Check(value, rule)) fault_ = std::string(name) + ": " + fault;
  }
  template <class T, class Part>
  void Nested(const char* name, T& value, Part) {
    if (fault_) return;
    Part::Visit(*this, value);
    if constexpr (std::is_same_v<Part, Description<std::remove_const_t<T>>>) CheckTogether(value);
    if (fault_) fault_->insert(0, std::string(name) + ".");
  }
  template <class T, class R = AnyValue>
  void Array(const char*, const char* name, T& vector, R rule = {}) {
    if constexpr (sizeof(typename T::value_type) > 1) {  // bytes may be anything
      if (!fault_ && std::ssize(vector) > kMaxElements) fault_ = std::string(name) + ": too many";
      for (std::size_t i = 0; i < vector.size() && !fault_; ++i) {
        (*this)("", vector[i], rule);
        if (fault_) fault_->insert(0, std::string(name) + "[" + std::to_string(i) + "]");
      }
    }
  }
  /// The rules between the members of `value`.
  template <class T>
  void CheckTogether(const T& value) {
    if constexpr (requires { value.Validate(); }) {
      if (!fault_) fault_ = value.Validate();
    }
  }
  const Fault& fault() const { return fault_; }

 private:
  template <class T, class F>
  static bool All(const T& value, F&& holds) {
    bool all = true;
    ForEachScalar(value, [&](const auto& scalar) { all = all && holds(scalar); });
    return all;
  }

  template <class T>
  static const char* Check(const T& value, AnyValue) {
    static_assert(!std::is_enum_v<T>, "say with OneOf what an enumeration may be");
    if constexpr (IsRotation<T>) {
      const bool is_unit =
          value.coeffs().allFinite() && std::abs(value.norm() - 1) <= kUnitTolerance;
      return is_unit ? nullptr : "is no unit quaternion";
    } else if constexpr (requires { value.IsValid(); }) {
      return value == T() || value.IsSound() ? nullptr : "id out of range";
    } else {
      const bool finite = All(value, [](auto x) {
        if constexpr (std::is_floating_point_v<decltype(x)>) return std::isfinite(x);
        return true;
      });
      return finite ? nullptr : "is not a finite number";
    }
  }
  template <class T>
  static const char* Check(const T& id, Required) {
    return id.IsSound() ? nullptr : "id out of range";
  }
  template <class T>
  static const char* Check(const T& value, Between range) {
    static_assert(std::is_integral_v<T>);
    return value >= range.low && value <= range.high ? nullptr : "out of range";
  }
  template <class T>
  static const char* Check(const T& value, Within range) {
    const bool within =
        All(value, [&](double x) { return x >= range.low && x <= range.high; });  // not for NaN
    return within ? nullptr : "out of range";
  }
  static const char* Check(double ms, Duration) {
    return std::isnan(ms) || (ms > -1 && ms < 1e9) ? nullptr : "is no duration";
  }
  template <class T>
  static const char* Check(const T& vector, UnitLength) {
    const bool is_unit = vector.allFinite() && std::abs(vector.norm() - 1) <= kUnitTolerance;
    return is_unit ? nullptr : "is no unit vector";
  }
  template <class T, auto... values>
  static const char* Check(T value, OneOf<values...>) {
    return ((value == values) || ...) ? nullptr : "is unknown";
  }
  static const char* Check(const std::string& name, ProcessName rule) {
    const bool ok = (rule.may_be_empty && name.empty()) || IsProcessName(name);
    return ok ? nullptr : "alien name";
  }
  static const char* Check(const std::string& text, Text rule) {
    const bool ok = text.size() <= rule.max_length && text.find('\0') == std::string::npos;
    return ok ? nullptr : "too long or with a zero byte";
  }

  Fault fault_;
};

/// nullopt if the message is sound.
template <class T>
Fault Validate(const T& message) {
  if (const char* misfit = CollectArrayLengths(message).misfit()) {
    return std::string(misfit) + ": not as many as what they belong to";
  }
  Validator validator;
  Description<T>::Visit(validator, message);
  validator.CheckTogether(message);
  return validator.fault();
}

}  // namespace vpslam
