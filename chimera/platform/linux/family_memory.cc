// SPDX-License-Identifier: Apache-2.0
// Maps shared anonymous memory.
#include "chimera/platform/family_memory.h"

#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include "chimera/base/message.h"

namespace chimera {

Result<FamilyMemory> FamilyMemory::create(std::uint64_t bytes) noexcept {
  void* base = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (base == MAP_FAILED) return (Message() << std::strerror(errno)).error(ErrorCode::kSystem);
  return FamilyMemory(static_cast<std::byte*>(base), bytes);
}

FamilyMemory::~FamilyMemory() {
  if (base_ != nullptr) ::munmap(base_, size_);
}

}  // namespace chimera
