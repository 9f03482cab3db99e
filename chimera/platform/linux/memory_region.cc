// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/memory_region.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "chimera/base/message.h"

namespace chimera {
namespace {

constexpr int kSeals = F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;

Error system_error(const char* what, std::uint64_t bytes) noexcept {
  const int error = errno;
  return (Message() << "shared memory of " << bytes << " bytes: " << what << " failed: " << ::strerrordesc_np(error))
      .error(ErrorCode::kSystem);
}

std::uint64_t whole_pages(std::uint64_t bytes) noexcept {
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return (bytes + page - 1) / page * page;
}

// Closes unless released.
struct Descriptor {
  explicit Descriptor(int f) noexcept : fd(f) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  int release() noexcept { return std::exchange(fd, -1); }
  int fd;
};

void* map(int fd, std::uint64_t size, int protection) noexcept {
  void* p = ::mmap(nullptr, size, protection, MAP_SHARED, fd, 0);
  return p == MAP_FAILED ? nullptr : p;
}

}  // namespace

Result<MemoryRegion> MemoryRegion::create(const char* name, std::uint64_t bytes) noexcept {
  if (bytes == 0) return Message("shared memory of 0 bytes makes no sense").error(ErrorCode::kBadInput);
  const std::uint64_t size = whole_pages(bytes);
  Descriptor file(::memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (file.fd < 0) return system_error("memfd_create", bytes);
  if (::fchmod(file.fd, 0600) != 0) return system_error("fchmod", bytes);
  if (size > INT64_MAX || ::ftruncate(file.fd, static_cast<off_t>(size)) != 0) return system_error("ftruncate", bytes);
  void* base = map(file.fd, size, PROT_READ | PROT_WRITE);
  if (base == nullptr) return system_error("mmap", bytes);
  if (::fcntl(file.fd, F_ADD_SEALS, kSeals) != 0) {
    const Error error = system_error("sealing", bytes);
    ::munmap(base, size);
    return error;
  }
  return MemoryRegion(file.release(), static_cast<std::byte*>(base), size, true);
}

Result<MemoryRegion> MemoryRegion::open_read_only(int descriptor, std::uint64_t expected_bytes) noexcept {
  const int seals = ::fcntl(descriptor, F_GET_SEALS);
  if (seals < 0 || (seals & kSeals) != kSeals)
    return (Message() << "descriptor " << descriptor
                      << " is not a sealed memory region: its owner could shrink it, or a stranger write to it")
        .error(ErrorCode::kRefused);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return system_error("fstat", expected_bytes);
  const std::uint64_t size = whole_pages(expected_bytes);
  if (expected_bytes == 0 || static_cast<std::uint64_t>(status.st_size) != size)
    return (Message() << "memory region has " << status.st_size << " bytes, expected " << size)
        .error(ErrorCode::kBadInput);
  Descriptor file(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (file.fd < 0) return system_error("dup", expected_bytes);
  void* base = map(file.fd, size, PROT_READ);
  if (base == nullptr) return system_error("mmap", expected_bytes);
  return MemoryRegion(file.release(), static_cast<std::byte*>(base), size, false);
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

}  // namespace chimera
