// SPDX-License-Identifier: Apache-2.0
// Memory that several processes map. The kinds differ in the processes that may write:
//   MemoryRegion   the process that made it
//   SharedPages    every process that has the descriptor
//   FrozenBytes    no process
//   FamilyMemory   the process that made it and the children that it forks
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/result.h"

namespace chimera {

/// A mapping, and the descriptor of its file (-1: none). Move-only; unmaps and closes.
class MappedMemory {
 public:
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;

 protected:
  MappedMemory() noexcept = default;
  MappedMemory(int descriptor, std::byte* base, std::uint64_t size) noexcept
      : descriptor_(descriptor), base_(base), size_(size) {}
  MappedMemory(MappedMemory&& other) noexcept { swap(other); }
  MappedMemory& operator=(MappedMemory&& other) noexcept {
    swap(other);
    return *this;
  }
  ~MappedMemory();

  int descriptor_ = -1;
  std::byte* base_ = nullptr;
  std::uint64_t size_ = 0;

 private:
  void swap(MappedMemory& other) noexcept;
};

/// Memory that one process writes and others read. An anonymous file in memory (memfd, mode 0600) and one mapping of
/// the file. The file has no name in any folder and ends with its last descriptor and mapping.
class MemoryRegion : private MappedMemory {
 public:
  /// Makes `bytes` zeroed bytes (rounded up to whole pages), maps them writable here, and then seals the file: no
  /// process, whatever its rights, can map it writable again, write to it, or change its size. This mapping stays the
  /// only writable one (a forked child inherits it). `name` shows in /proc only.
  /// Refuses 0 bytes, and a refusal of the system. Context: setup; may block.
  static Result<MemoryRegion> create(const char* name, std::uint64_t bytes) noexcept;
  /// Maps the file of `descriptor` read-only; duplicates the descriptor. Refuses a file without all seals, because its
  /// owner could shrink it or a stranger write to it; and a file whose size is not `expected_bytes` rounded up to
  /// whole pages. Context: setup; may block.
  static Result<MemoryRegion> open_read_only(int descriptor, std::uint64_t expected_bytes) noexcept;

  MemoryRegion() noexcept = default;

  /// The bytes to write. Empty if this mapping is read-only.
  std::span<std::byte> writable() const noexcept {
    return is_writable_ ? std::span(base_, size_) : std::span<std::byte>();
  }
  std::span<const std::byte> bytes() const noexcept { return {base_, size_}; }
  /// A child that this process forks later does not get these bytes: a child that uses them ends by SIGSEGV. False if
  /// the system refuses. Context: setup.
  bool keep_from_children() const noexcept;
  /// For other processes, by inheritance or over a Unix socket. Owned by the region.
  int descriptor() const noexcept { return descriptor_; }

 private:
  MemoryRegion(int descriptor, std::byte* base, std::uint64_t size, bool is_writable) noexcept
      : MappedMemory(descriptor, base, size), is_writable_(is_writable) {}

  bool is_writable_ = false;
};

/// Memory for words whose wrong value does no harm: a memfd (mode 0600) that stays writable and never changes its size,
/// and one mapping of it.
class SharedPages : private MappedMemory {
 public:
  /// `bytes` zeroed bytes, rounded up to whole pages. Refuses 0 bytes, and a refusal of the system.
  /// Context: setup; may block.
  static Result<SharedPages> create(const char* name, std::uint64_t bytes) noexcept;
  /// Maps the file of `descriptor`; duplicates the descriptor. Refuses a file that could change its size, and a file
  /// whose size is not `expected_bytes` rounded up to whole pages. Context: setup; may block.
  static Result<SharedPages> open(int descriptor, std::uint64_t expected_bytes) noexcept;

  SharedPages() noexcept = default;

  std::span<std::byte> bytes() const noexcept { return {base_, size_}; }
  /// For other processes. Owned by the pages.
  int descriptor() const noexcept { return descriptor_; }

 private:
  SharedPages(int descriptor, std::byte* base, std::uint64_t size) noexcept : MappedMemory(descriptor, base, size) {}
};

/// A memfd (mode 0600) that is sealed against every change, and one read-only mapping of it.
class FrozenBytes : private MappedMemory {
 public:
  /// A copy of `content`. Refuses 0 bytes, and a refusal of the system. Context: setup; may block.
  static Result<FrozenBytes> create(const char* name, std::span<const std::byte> content) noexcept;
  /// Maps the whole file of `descriptor`; duplicates the descriptor. Refuses a file that is not sealed against every
  /// change, and an empty file. Context: setup; may block.
  static Result<FrozenBytes> open(int descriptor) noexcept;

  FrozenBytes() noexcept = default;

  std::span<const std::byte> bytes() const noexcept { return {base_, size_}; }
  /// For other processes. Owned by this object.
  int descriptor() const noexcept { return descriptor_; }

 private:
  FrozenBytes(int descriptor, std::byte* base, std::uint64_t size) noexcept : MappedMemory(descriptor, base, size) {}
};

/// Zeroed bytes without a name or descriptor, shared with children that this process forks later. Bytes that a child
/// wrote outlive the child. Context: setup.
class FamilyMemory : private MappedMemory {
 public:
  /// Refuses 0 bytes, and a refusal of the system, with its reason. Pages take memory at their first use only.
  static Result<FamilyMemory> create(std::uint64_t bytes) noexcept;

  FamilyMemory() noexcept = default;

  std::span<std::byte> bytes() const noexcept { return {base_, size_}; }

 private:
  FamilyMemory(int descriptor, std::byte* base, std::uint64_t size) noexcept : MappedMemory(descriptor, base, size) {}
};

}  // namespace chimera
