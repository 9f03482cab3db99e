// SPDX-License-Identifier: Apache-2.0
// The source of the memory that setup uses. Memory is returned only all together. It comes from a heap
// (runtime/hosted/heap_memory.h), or, on a machine without a heap, from bytes that the image reserves (GivenMemory).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>

#include "chimera/base/assert.h"

namespace chimera {

/// Context of everything: setup.
class SetupMemory {
 public:
  /// `n` values of T, constructed by T(). Their destructors never run.
  template <class T>
  std::span<T> take(std::size_t n) {
    static_assert(std::is_trivially_destructible_v<T>);
    const std::span<std::byte> bytes = take_bytes(n * sizeof(T), alignof(T));
    T* const first = reinterpret_cast<T*>(bytes.data());
    for (std::size_t i = 0; i < n; ++i) ::new (static_cast<void*>(first + i)) T();
    return {first, n};
  }
  /// `size` zeroed bytes; `alignment` is a power of two.
  virtual std::span<std::byte> take_bytes(std::size_t size, std::size_t alignment) = 0;
  /// Never frees this memory, because a thread that hangs may still use it.
  virtual void keep_for_ever() noexcept = 0;

 protected:
  ~SetupMemory() = default;
};

/// Memory from given bytes, which must outlive all values in it. Requires: enough bytes; used() returns the number
/// needed. `too_small` says so, and does not return.
class GivenMemory final : public SetupMemory {
 public:
  using TooSmall = void (*)(std::size_t bytes);

  explicit GivenMemory(std::span<std::byte> bytes, TooSmall too_small = nullptr) noexcept
      : bytes_(bytes), too_small_(too_small) {}

  std::span<std::byte> take_bytes(std::size_t size, std::size_t alignment) override {
    const auto begin = reinterpret_cast<std::uintptr_t>(bytes_.data());
    const std::size_t at = ((begin + used_ + alignment - 1) & ~(alignment - 1)) - begin;
    const bool fits = at <= bytes_.size() && size <= bytes_.size() - at;
    if (!fits && too_small_ != nullptr) too_small_(bytes_.size());
    CHIMERA_ASSERT(fits);
    used_ = at + size;
    if (size != 0) std::memset(bytes_.data() + at, 0, size);
    return bytes_.subspan(at, size);
  }
  void keep_for_ever() noexcept override {}
  std::size_t used() const noexcept { return used_; }

 private:
  std::span<std::byte> bytes_;
  TooSmall too_small_;
  std::size_t used_ = 0;
};

}  // namespace chimera
