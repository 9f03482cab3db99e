// SPDX-License-Identifier: Apache-2.0
// A part of an object that images without its mechanism lack (mechanisms.h): there it has no memory, and no code.
#pragma once

#include <type_traits>
#include <utility>

namespace chimera {

/// Holds a T if `kIsThere`; otherwise it is empty, ignores what it is made from, and get() is null. Use what it holds
/// under `if constexpr` of the mechanism. Context: that of T.
template <bool kIsThere, class T>
class PartIf {
 public:
  template <class... Args>
  constexpr explicit PartIf(Args&&... args) : part_(std::forward<Args>(args)...) {}
  constexpr T* get() noexcept { return &part_; }
  constexpr T* operator->() noexcept { return &part_; }
  constexpr T& operator*() noexcept { return part_; }

 private:
  T part_;
};

template <class T>
class PartIf<false, T> {
 public:
  template <class... Args>
  constexpr explicit PartIf(Args&&...) noexcept {}
  constexpr T* get() noexcept { return nullptr; }
  constexpr T* operator->() noexcept { return nullptr; }
  constexpr T& operator*() noexcept { __builtin_unreachable(); }
};

/// In place of a value that images without its mechanism lack: it ignores what it is set to. Use what stands in the
/// other images under `if constexpr` of the mechanism. Context: that of T.
template <class T>
class NoValue {
 public:
  constexpr NoValue() noexcept = default;
  constexpr NoValue(const T&) noexcept {}  // NOLINT: in its place
  constexpr NoValue& operator=(const T&) noexcept { return *this; }
  constexpr operator T() const noexcept { return T{}; }
};
template <bool kIsThere, class T>
using ValueIf = std::conditional_t<kIsThere, T, NoValue<T>>;

}  // namespace chimera
