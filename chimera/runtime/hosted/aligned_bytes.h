// SPDX-License-Identifier: Apache-2.0
// Zeroed memory at a stated alignment, released with its owner.
#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <utility>

namespace chimera {

/// Context: setup. Movable, not copyable; the address never changes.
class AlignedBytes {
 public:
  AlignedBytes() noexcept = default;
  /// `size` zeroed bytes; `alignment` is a power of two.
  AlignedBytes(std::size_t size, std::size_t alignment)
      : size_(size), alignment_(alignment),
        bytes_(static_cast<std::byte*>(::operator new(size == 0 ? 1 : size, std::align_val_t{alignment}))) {
    clear();
  }
  AlignedBytes(AlignedBytes&& other) noexcept
      : size_(other.size_), alignment_(other.alignment_), bytes_(std::exchange(other.bytes_, nullptr)) {}
  AlignedBytes& operator=(AlignedBytes&& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(alignment_, other.alignment_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~AlignedBytes() {
    if (bytes_ != nullptr) ::operator delete(bytes_, std::align_val_t{alignment_});
  }

  std::byte* data() const noexcept { return bytes_; }
  std::span<std::byte> span() const noexcept { return {bytes_, size_}; }
  void clear() noexcept { std::memset(bytes_, 0, size_); }

 private:
  std::size_t size_ = 0;
  std::size_t alignment_ = 1;
  std::byte* bytes_ = nullptr;
};

}  // namespace chimera
