// SPDX-License-Identifier: Apache-2.0
// Makes, judges and maps the memfds of MemoryRegion and SharedPages.
#include "chimera/platform/linux/memory_file.h"

#include <fcntl.h>
#include <sys/stat.h>

namespace chimera {

Result<OwnedDescriptor> make_memory_file(const char* name, std::uint64_t bytes, std::uint64_t size) noexcept {
  if (bytes == 0) return Message("shared memory of 0 bytes makes no sense").error(ErrorCode::kBadInput);
  OwnedDescriptor file(::memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (file.fd < 0) return memory_error("memfd_create", bytes);
  if (::fchmod(file.fd, 0600) != 0) return memory_error("fchmod", bytes);
  if (size > INT64_MAX || ::ftruncate(file.fd, static_cast<off_t>(size)) != 0) return memory_error("ftruncate", bytes);
  return file;
}

Result<std::uint64_t> sealed_size(int descriptor, int seals) noexcept {
  const int present = ::fcntl(descriptor, F_GET_SEALS);
  if (present < 0 || (present & seals) != seals)
    return (Message() << "descriptor " << descriptor
                      << " is not a sealed memory region: its owner could shrink it, or a stranger write to it")
        .error(ErrorCode::kRefused);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return memory_error("fstat", 0);
  return static_cast<std::uint64_t>(status.st_size);
}

std::byte* map_memory(int fd, std::uint64_t size, int protection) noexcept {
  void* p = ::mmap(nullptr, size, protection, MAP_SHARED, fd, 0);
  return p == MAP_FAILED ? nullptr : static_cast<std::byte*>(p);
}

}  // namespace chimera
