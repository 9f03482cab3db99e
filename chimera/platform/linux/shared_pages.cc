// SPDX-License-Identifier: Apache-2.0
// Makes memory that several processes write: a memfd whose size is sealed.
#include "chimera/platform/shared_pages.h"

#include <fcntl.h>

#include "chimera/platform/linux/memory_file.h"

namespace chimera {
namespace {

constexpr int kSeals = F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL;

}  // namespace

Result<SharedPages> SharedPages::create(const char* name, std::uint64_t bytes) noexcept {
  const std::uint64_t size = whole_pages(bytes);
  auto file = make_memory_file(name, bytes, size);
  if (!file) return file.error();
  if (::fcntl(file->fd, F_ADD_SEALS, kSeals) != 0) return memory_error("sealing", bytes);
  return open(file->fd, bytes);
}

Result<SharedPages> SharedPages::open(int descriptor, std::uint64_t expected_bytes) noexcept {
  const auto present = sealed_size(descriptor, kSeals);
  if (!present) return present.error();
  const std::uint64_t size = whole_pages(expected_bytes);
  if (expected_bytes == 0 || *present != size)
    return (Message() << "shared pages have " << *present << " bytes, expected " << size).error(ErrorCode::kBadInput);
  OwnedDescriptor file(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (file.fd < 0) return memory_error("dup", expected_bytes);
  std::byte* base = map_memory(file.fd, size, PROT_READ | PROT_WRITE);
  if (base == nullptr) return memory_error("mmap", expected_bytes);
  return SharedPages(file.release(), base, size);
}

SharedPages& SharedPages::operator=(SharedPages&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(base_, other.base_);
  std::swap(size_, other.size_);
  return *this;
}

SharedPages::~SharedPages() {
  if (base_ != nullptr) ::munmap(base_, size_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace chimera
