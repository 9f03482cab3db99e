// SPDX-License-Identifier: Apache-2.0
// Memory that a process shares with the children it forks afterwards: what a child wrote there outlives it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "chimera/base/result.h"

namespace chimera {

/// Zeroed bytes without a name or descriptor. Move-only; unmaps. Context: setup.
class FamilyMemory {
 public:
  /// Refuses 0 bytes, and what the system refuses with its reason. Pages that nobody touches take no memory.
  static Result<FamilyMemory> create(std::uint64_t bytes) noexcept;

  FamilyMemory() noexcept = default;
  FamilyMemory(FamilyMemory&& other) noexcept
      : base_(std::exchange(other.base_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  FamilyMemory& operator=(FamilyMemory&& other) noexcept {
    std::swap(base_, other.base_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~FamilyMemory();

  std::span<std::byte> bytes() const noexcept { return {base_, size_}; }

 private:
  FamilyMemory(std::byte* base, std::uint64_t size) noexcept : base_(base), size_(size) {}

  std::byte* base_ = nullptr;
  std::uint64_t size_ = 0;
};

}  // namespace chimera
