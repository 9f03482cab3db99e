// SPDX-License-Identifier: Apache-2.0
// Memory that everybody who is handed its descriptor may write: for words whose wrong value does no harm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "chimera/base/result.h"

namespace chimera {

/// A memfd (mode 0600) that stays writable and keeps its size for ever, and one mapping of it. Move-only; unmaps and
/// closes. Memory with one writer: MemoryRegion.
class SharedPages {
 public:
  /// `bytes` zeroed bytes, rounded up to whole pages. Refuses 0 bytes, and what the system refuses.
  /// Context: setup; may block.
  static Result<SharedPages> create(const char* name, std::uint64_t bytes) noexcept;
  /// Maps what `descriptor` names; duplicates the descriptor. Refuses a file that could change its size, and one of
  /// another size than `expected_bytes` rounded up to pages. Context: setup; may block.
  static Result<SharedPages> open(int descriptor, std::uint64_t expected_bytes) noexcept;

  SharedPages() noexcept = default;
  SharedPages(SharedPages&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)),
        base_(std::exchange(other.base_, nullptr)),
        size_(std::exchange(other.size_, 0)) {}
  SharedPages& operator=(SharedPages&& other) noexcept;
  ~SharedPages();

  std::span<std::byte> bytes() const noexcept { return {base_, size_}; }
  /// To hand on. Owned by the pages.
  int descriptor() const noexcept { return descriptor_; }

 private:
  SharedPages(int descriptor, std::byte* base, std::uint64_t size) noexcept
      : descriptor_(descriptor), base_(base), size_(size) {}

  int descriptor_ = -1;
  std::byte* base_ = nullptr;
  std::uint64_t size_ = 0;
};

}  // namespace chimera
