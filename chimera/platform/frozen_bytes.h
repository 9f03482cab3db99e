// SPDX-License-Identifier: Apache-2.0
// Bytes that nobody can change any more, for processes that are handed their descriptor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "chimera/base/result.h"

namespace chimera {

/// A memfd (mode 0600) sealed against every change, and one read-only mapping of it. Move-only; unmaps and closes.
class FrozenBytes {
 public:
  /// A copy of `content`. Refuses 0 bytes, and what the system refuses. Context: setup; may block.
  static Result<FrozenBytes> create(const char* name, std::span<const std::byte> content) noexcept;
  /// Maps what `descriptor` names, whole; duplicates the descriptor. Refuses a file that is not sealed against
  /// everything, and an empty one. Context: setup; may block.
  static Result<FrozenBytes> open(int descriptor) noexcept;

  FrozenBytes() noexcept = default;
  FrozenBytes(FrozenBytes&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)),
        base_(std::exchange(other.base_, nullptr)),
        size_(std::exchange(other.size_, 0)) {}
  FrozenBytes& operator=(FrozenBytes&& other) noexcept;
  ~FrozenBytes();

  std::span<const std::byte> bytes() const noexcept { return {base_, size_}; }
  /// To hand on. Owned by this.
  int descriptor() const noexcept { return descriptor_; }

 private:
  FrozenBytes(int descriptor, std::byte* base, std::uint64_t size) noexcept
      : descriptor_(descriptor), base_(base), size_(size) {}

  int descriptor_ = -1;
  std::byte* base_ = nullptr;
  std::uint64_t size_ = 0;
};

}  // namespace chimera
