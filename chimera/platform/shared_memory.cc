// SPDX-License-Identifier: Apache-2.0
// Makes, seals, checks and maps memory files, and maps anonymous memory for forked children.
#include "chimera/platform/shared_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "chimera/platform/descriptor.h"
#include "chimera/platform/process_state.h"

namespace chimera {
namespace {

constexpr int kFixedSize = F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL;
constexpr int kOneWriter = kFixedSize | F_SEAL_FUTURE_WRITE;
constexpr int kNoWriter = kFixedSize | F_SEAL_WRITE;

std::uint64_t whole_pages(std::uint64_t bytes) noexcept {
  const std::uint64_t page = page_bytes();
  return (bytes + page - 1) / page * page;
}

Error memory_error(const char* call, std::uint64_t bytes) noexcept {
  return system_error(Message() << "shared memory of " << bytes << " bytes", call);
}

/// A memfd of `size` zeroed bytes, mode 0600, not sealed yet. The message of a refusal names `bytes`, the asked size.
Result<OwnedDescriptor> make_memory_file(const char* name, std::uint64_t bytes, std::uint64_t size) noexcept {
  if (bytes == 0) return Message("shared memory of 0 bytes makes no sense").error(ErrorCode::kBadInput);
  OwnedDescriptor file(::memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (file.fd < 0) return memory_error("memfd_create", bytes);
  if (::fchmod(file.fd, 0600) != 0) return memory_error("fchmod", bytes);
  if (size > INT64_MAX || ::ftruncate(file.fd, static_cast<off_t>(size)) != 0) return memory_error("ftruncate", bytes);
  return file;
}

/// Size of the file of `descriptor`; refuses a descriptor that is no memory file or lacks one of `seals`.
Result<std::uint64_t> sealed_size(int descriptor, int seals) noexcept {
  if (descriptor < 0) {
    errno = EMFILE;
    return memory_error("receiving its descriptor", 0);
  }
  const int present = ::fcntl(descriptor, F_GET_SEALS);
  if (present < 0 || (present & seals) != seals)
    return (Message() << "descriptor " << descriptor
                      << " is not a sealed memory region: its owner could shrink it, or a stranger write to it")
        .error(ErrorCode::kRefused);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return memory_error("fstat", 0);
  return static_cast<std::uint64_t>(status.st_size);
}

/// Null if the system refuses.
std::byte* map_file(int fd, std::uint64_t size, int protection) noexcept {
  void* p = ::mmap(nullptr, size, protection, MAP_SHARED, fd, 0);
  return p == MAP_FAILED ? nullptr : static_cast<std::byte*>(p);
}

struct MappedCopy {
  OwnedDescriptor file;
  std::byte* base = nullptr;
};

/// Duplicates the descriptor of a memory file and maps the file. The message of a refusal names `bytes`.
Result<MappedCopy> map_copy(int descriptor, std::uint64_t bytes, std::uint64_t size, int protection) noexcept {
  OwnedDescriptor file(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (file.fd < 0) return memory_error("dup", bytes);
  std::byte* base = map_file(file.fd, size, protection);
  if (base == nullptr) return memory_error("mmap", bytes);
  return MappedCopy{std::move(file), base};
}

bool write_all(int fd, std::span<const std::byte> content) noexcept {
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t n = ::pwrite(fd, content.data() + done, content.size() - done, static_cast<off_t>(done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

void MappedMemory::swap(MappedMemory& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(base_, other.base_);
  std::swap(size_, other.size_);
}

MappedMemory::~MappedMemory() {
  if (base_ != nullptr) ::munmap(base_, size_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<MemoryRegion> MemoryRegion::create(const char* name, std::uint64_t bytes) noexcept {
  const std::uint64_t size = whole_pages(bytes);
  auto file = make_memory_file(name, bytes, size);
  if (!file) return file.error();
  std::byte* base = map_file(file->fd, size, PROT_READ | PROT_WRITE);
  if (base == nullptr) return memory_error("mmap", bytes);
  MemoryRegion region(file->release(), base, size, true);
  if (::fcntl(region.descriptor_, F_ADD_SEALS, kOneWriter) != 0) return memory_error("sealing", bytes);
  return region;
}

Result<MemoryRegion> MemoryRegion::open_read_only(int descriptor, std::uint64_t expected_bytes) noexcept {
  const auto present = sealed_size(descriptor, kOneWriter);
  if (!present) return present.error();
  const std::uint64_t size = whole_pages(expected_bytes);
  if (expected_bytes == 0 || *present != size)
    return (Message() << "memory region has " << *present << " bytes, expected " << size).error(ErrorCode::kBadInput);
  auto mapped = map_copy(descriptor, expected_bytes, size, PROT_READ);
  if (!mapped) return mapped.error();
  return MemoryRegion(mapped->file.release(), mapped->base, size, false);
}

bool MemoryRegion::keep_from_children() const noexcept {
  return base_ != nullptr && ::madvise(base_, size_, MADV_DONTFORK) == 0;
}

Result<SharedPages> SharedPages::create(const char* name, std::uint64_t bytes) noexcept {
  auto file = make_memory_file(name, bytes, whole_pages(bytes));
  if (!file) return file.error();
  if (::fcntl(file->fd, F_ADD_SEALS, kFixedSize) != 0) return memory_error("sealing", bytes);
  return open(file->fd, bytes);
}

Result<SharedPages> SharedPages::open(int descriptor, std::uint64_t expected_bytes) noexcept {
  const auto present = sealed_size(descriptor, kFixedSize);
  if (!present) return present.error();
  const std::uint64_t size = whole_pages(expected_bytes);
  if (expected_bytes == 0 || *present != size)
    return (Message() << "shared pages have " << *present << " bytes, expected " << size).error(ErrorCode::kBadInput);
  auto mapped = map_copy(descriptor, expected_bytes, size, PROT_READ | PROT_WRITE);
  if (!mapped) return mapped.error();
  return SharedPages(mapped->file.release(), mapped->base, size);
}

Result<FrozenBytes> FrozenBytes::create(const char* name, std::span<const std::byte> content) noexcept {
  auto file = make_memory_file(name, content.size(), content.size());
  if (!file) return file.error();
  if (!write_all(file->fd, content)) return memory_error("pwrite", content.size());
  if (::fcntl(file->fd, F_ADD_SEALS, kNoWriter) != 0) return memory_error("sealing", content.size());
  return open(file->fd);
}

Result<FrozenBytes> FrozenBytes::open(int descriptor) noexcept {
  const auto size = sealed_size(descriptor, kNoWriter);
  if (!size) return size.error();
  if (*size == 0) return Message("memory file of 0 bytes makes no sense").error(ErrorCode::kBadInput);
  auto mapped = map_copy(descriptor, *size, *size, PROT_READ);
  if (!mapped) return mapped.error();
  return FrozenBytes(mapped->file.release(), mapped->base, *size);
}

Result<FamilyMemory> FamilyMemory::create(std::uint64_t bytes) noexcept {
  void* base = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (base == MAP_FAILED) return (Message() << std::strerror(errno)).error(ErrorCode::kSystem);
  return FamilyMemory(-1, static_cast<std::byte*>(base), bytes);
}

}  // namespace chimera
