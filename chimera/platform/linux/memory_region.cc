// SPDX-License-Identifier: Apache-2.0
// Makes memory that one process writes and others read: mapped writable once, then sealed against further writers.
#include "chimera/platform/memory_region.h"

#include <fcntl.h>
#include <sys/mman.h>

#include <utility>

#include "chimera/platform/linux/memory_file.h"

namespace chimera {
namespace {

constexpr int kSeals = F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;

}  // namespace

Result<MemoryRegion> MemoryRegion::create(const char* name, std::uint64_t bytes) noexcept {
  const std::uint64_t size = whole_pages(bytes);
  auto file = make_memory_file(name, bytes, size);
  if (!file) return file.error();
  std::byte* base = map_memory(file->fd, size, PROT_READ | PROT_WRITE);
  if (base == nullptr) return memory_error("mmap", bytes);
  if (::fcntl(file->fd, F_ADD_SEALS, kSeals) != 0) {
    const Error error = memory_error("sealing", bytes);
    ::munmap(base, size);
    return error;
  }
  return MemoryRegion(file->release(), base, size, true);
}

Result<MemoryRegion> MemoryRegion::open_read_only(int descriptor, std::uint64_t expected_bytes) noexcept {
  const auto present = sealed_size(descriptor, kSeals);
  if (!present) return present.error();
  const std::uint64_t size = whole_pages(expected_bytes);
  if (expected_bytes == 0 || *present != size)
    return (Message() << "memory region has " << *present << " bytes, expected " << size)
        .error(ErrorCode::kBadInput);
  OwnedDescriptor file(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (file.fd < 0) return memory_error("dup", expected_bytes);
  std::byte* base = map_memory(file.fd, size, PROT_READ);
  if (base == nullptr) return memory_error("mmap", expected_bytes);
  return MemoryRegion(file.release(), base, size, false);
}

MemoryRegion::MemoryRegion(MemoryRegion&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      base_(std::exchange(other.base_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      is_writable_(other.is_writable_) {}

MemoryRegion& MemoryRegion::operator=(MemoryRegion&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(base_, other.base_);
  std::swap(size_, other.size_);
  std::swap(is_writable_, other.is_writable_);
  return *this;
}

MemoryRegion::~MemoryRegion() {
  if (base_ != nullptr) ::munmap(base_, size_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::span<std::byte> MemoryRegion::writable() const noexcept {
  return is_writable_ ? std::span(base_, size_) : std::span<std::byte>();
}

bool MemoryRegion::keep_from_children() const noexcept {
  return base_ != nullptr && ::madvise(base_, size_, MADV_DONTFORK) == 0;
}

}  // namespace chimera
