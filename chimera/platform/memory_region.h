// SPDX-License-Identifier: Apache-2.0
// Memory that several processes map: written by the one that made it, read by those it hands the descriptor to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/result.h"

namespace chimera {

/// An anonymous file in memory (memfd, mode 0600) and one mapping of it. Has no name anywhere, so nothing is left
/// behind; it ends with the last descriptor and mapping. Move-only; unmaps and closes.
class MemoryRegion {
 public:
  /// Makes `bytes` zeroed bytes (rounded up to whole pages), mapped writable here, and then sealed: from now on
  /// nobody, whatever rights it has, can map it writable again, write to the file, or change its size. This mapping
  /// is the only writable one there will ever be (a forked child inherits it). `name` shows in /proc only.
  /// Refuses 0 bytes, and what the system refuses. Context: setup; may block.
  static Result<MemoryRegion> create(const char* name, std::uint64_t bytes) noexcept;
  /// Maps read-only what `descriptor` names; duplicates the descriptor. Refuses a file that could still shrink
  /// under the mapping or be written by a stranger (seals missing), and one that has fewer bytes than
  /// `expected_bytes` rounded up to pages, or more. Context: setup; may block.
  static Result<MemoryRegion> open_read_only(int descriptor, std::uint64_t expected_bytes) noexcept;

  MemoryRegion() noexcept = default;
  MemoryRegion(MemoryRegion&& other) noexcept;
  MemoryRegion& operator=(MemoryRegion&& other) noexcept;
  ~MemoryRegion();

  /// The bytes to write. Empty when this mapping is read-only.
  std::span<std::byte> writable() const noexcept;
  std::span<const std::byte> bytes() const noexcept { return {base_, size_}; }
  /// A child that this process forks from now on does not have these bytes: it ends by SIGSEGV where it goes on as if
  /// it were its parent. False when the system refuses. Context: setup.
  bool keep_from_children() const noexcept;
  /// To hand on: by inheritance or over a Unix socket. Owned by the region.
  int descriptor() const noexcept { return descriptor_; }

 private:
  MemoryRegion(int descriptor, std::byte* base, std::uint64_t size, bool is_writable) noexcept
      : descriptor_(descriptor), base_(base), size_(size), is_writable_(is_writable) {}

  int descriptor_ = -1;
  std::byte* base_ = nullptr;
  std::uint64_t size_ = 0;
  bool is_writable_ = false;
};

}  // namespace chimera
