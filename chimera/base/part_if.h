// SPDX-License-Identifier: Apache-2.0
// A part of an object that images without its mechanism lack (mechanisms.h): there it has no memory, and no code.
#pragma once

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

}  // namespace chimera
