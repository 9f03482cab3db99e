// SPDX-License-Identifier: Apache-2.0
// Copies bytes into a memfd, seals it against every change, and maps it.
#include "chimera/platform/frozen_bytes.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "chimera/platform/linux/memory_file.h"

namespace chimera {
namespace {

constexpr int kSeals = F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_WRITE | F_SEAL_SEAL;

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

Result<FrozenBytes> FrozenBytes::create(const char* name, std::span<const std::byte> content) noexcept {
  auto file = make_memory_file(name, content.size(), content.size());
  if (!file) return file.error();
  if (!write_all(file->fd, content)) return memory_error("pwrite", content.size());
  if (::fcntl(file->fd, F_ADD_SEALS, kSeals) != 0) return memory_error("sealing", content.size());
  return open(file->fd);
}

Result<FrozenBytes> FrozenBytes::open(int descriptor) noexcept {
  const auto size = sealed_size(descriptor, kSeals);
  if (!size) return size.error();
  if (*size == 0) return Message("memory file of 0 bytes makes no sense").error(ErrorCode::kBadInput);
  OwnedDescriptor file(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (file.fd < 0) return memory_error("dup", *size);
  std::byte* base = map_memory(file.fd, *size, PROT_READ);
  if (base == nullptr) return memory_error("mmap", *size);
  return FrozenBytes(file.release(), base, *size);
}

FrozenBytes& FrozenBytes::operator=(FrozenBytes&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(base_, other.base_);
  std::swap(size_, other.size_);
  return *this;
}

FrozenBytes::~FrozenBytes() {
  if (base_ != nullptr) ::munmap(base_, size_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace chimera
