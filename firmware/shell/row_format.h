// SPDX-License-Identifier: Apache-2.0
// The form of a row with gaps for values, judged while compiling.
#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "chimera/base/time.h"

namespace chimera::firmware {

/// A text in which %s stands for a string_view, %z a const char*, %u and %d a whole number of 32 bits, %l a signed one
/// of 64, %g a number, %t a time in seconds, %m a time in microseconds. A form that does not fit the values does not
/// compile. The text outlives this. Context: any; wait-free.
template <class... Values>
class RowFormat {
 public:
  consteval RowFormat(const char* text) : text_(text) {  // NOLINT: a text is a form
    constexpr char kKinds[] = {kind_of<Values>()..., '\0'};
    const char* kind = kKinds;
    for (const char* c = text; *c != '\0'; ++c) {
      if (*c != '%') continue;
      ++c;
      if (*kind == '\0' || (*c == 'm' ? 't' : *c) != *kind++) form_does_not_fit_the_values();
    }
    if (*kind != '\0') form_does_not_fit_the_values();
  }
  const char* text() const noexcept { return text_; }

 private:
  static void form_does_not_fit_the_values();  // no consteval function may call it

  template <class Value>
  static consteval char kind_of() {
    if constexpr (std::same_as<Value, std::string_view>) return 's';
    else if constexpr (std::convertible_to<Value, const char*>) return 'z';
    else if constexpr (std::same_as<Value, Nanoseconds>) return 't';
    else if constexpr (std::same_as<Value, double>) return 'g';
    else if constexpr (std::unsigned_integral<Value>) return sizeof(Value) <= sizeof(std::size_t) ? 'u' : '?';
    else if constexpr (std::signed_integral<Value>) return sizeof(Value) <= 4 ? 'd' : 'l';
    else return '?';
  }

  const char* text_;
};

}  // namespace chimera::firmware
