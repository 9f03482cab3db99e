// SPDX-License-Identifier: Apache-2.0
// Errors as values: an Error says which input was wrong, and where.
// (std::expected is C++23; the member names here are its own.)
#pragma once

#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "chimera/base/assert.h"
#include "chimera/base/fixed.h"
#include "chimera/base/mechanisms.h"

namespace chimera {

enum class ErrorCode : unsigned char {
  kBadInput,     // text, file or value that breaks a stated rule
  kNotFound,     // a name or file that does not exist
  kRefused,      // a legal request that the present state, rights or capacity do not allow
  kUnsupported,  // a mechanism that this build does not have
  kSystem,       // a failed call of the operating system
};

/// In place of the words of an error in an image, whose setup fails only if its parts do not belong together. Context:
/// any; wait-free.
class NoWords {
 public:
  constexpr NoWords() noexcept = default;
  constexpr NoWords(std::string_view) noexcept {}  // NOLINT: as FixedString
  constexpr void assign(std::string_view) noexcept {}
  constexpr const char* c_str() const noexcept { return ""; }
  constexpr std::string_view view() const noexcept { return "its parts are of different builds"; }
};
template <std::size_t n>
using ErrorWords = std::conditional_t<mechanisms::kVerified, NoWords, FixedString<n>>;

/// An error. `message` says what was found and what was expected. `where` names the place ("arm.yaml:12:8",
/// "/path/file.so"), or is empty. Trivially copyable: no heap.
struct Error {
  ErrorCode code = ErrorCode::kBadInput;
  ErrorWords<400> message;
  ErrorWords<200> where;
};

/// A T or an Error. If the caller reads the half that is absent, the program ends (CHIMERA_ASSERT). Context: setup.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) noexcept : half_(std::in_place_index<0>, std::move(value)) {}  // NOLINT: a value is a result
  Result(Error error) noexcept : half_(std::in_place_index<1>, error) {}         // NOLINT: so is an error

  bool has_value() const noexcept { return half_.index() == 0; }
  explicit operator bool() const noexcept { return has_value(); }
  T& value() & noexcept { CHIMERA_ASSERT(has_value()); return *std::get_if<0>(&half_); }
  const T& value() const& noexcept { CHIMERA_ASSERT(has_value()); return *std::get_if<0>(&half_); }
  T&& value() && noexcept { CHIMERA_ASSERT(has_value()); return std::move(*std::get_if<0>(&half_)); }
  const Error& error() const noexcept { CHIMERA_ASSERT(!has_value()); return *std::get_if<1>(&half_); }
  T& operator*() & noexcept { return value(); }
  const T& operator*() const& noexcept { return value(); }
  T&& operator*() && noexcept { return std::move(*this).value(); }
  T* operator->() noexcept { return &value(); }
  const T* operator->() const noexcept { return &value(); }

 private:
  std::variant<T, Error> half_;
};

/// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() noexcept = default;
  Result(Error error) noexcept : error_(error), failed_(true) {}  // NOLINT: an error is a result

  bool has_value() const noexcept { return !failed_; }
  explicit operator bool() const noexcept { return !failed_; }
  const Error& error() const noexcept { CHIMERA_ASSERT(failed_); return error_; }

 private:
  Error error_;
  bool failed_ = false;
};

}  // namespace chimera
