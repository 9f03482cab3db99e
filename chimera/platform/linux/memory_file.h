// SPDX-License-Identifier: Apache-2.0
// What all kinds of shared memory have in common: an anonymous file, and a mapping of it.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

#include "chimera/base/result.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

inline std::uint64_t whole_pages(std::uint64_t bytes) noexcept {
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return (bytes + page - 1) / page * page;
}

inline Error memory_error(const char* call, std::uint64_t bytes) noexcept {
  return system_error(Message() << "shared memory of " << bytes << " bytes", call);
}

/// A memfd of `size` zeroed bytes, mode 0600, not sealed yet. `bytes` is what was asked for, for the message.
Result<OwnedDescriptor> make_memory_file(const char* name, std::uint64_t bytes, std::uint64_t size) noexcept;
/// Size of the file behind `descriptor`; refuses one that is no memory file or lacks one of `seals`.
Result<std::uint64_t> sealed_size(int descriptor, int seals) noexcept;
/// Null when the system refuses.
std::byte* map_memory(int fd, std::uint64_t size, int protection) noexcept;

}  // namespace chimera
