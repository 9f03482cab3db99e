// SPDX-License-Identifier: Apache-2.0
// The memory layout of a group of state variables: docs/formats/table.md.
//
//   [counter: 8 bytes, last initial publication: 8 bytes, on a cache line of their own][slot 0][slot 1][slot 2][slot 3]
//   slot = chimera_slot header (32 bytes) + payload, rounded up to whole cache lines
//   publication n lies in slot n mod 4; publication 0 is the never-written fill
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/base/mechanisms.h"
#include "chimera/table/slot_header.h"

namespace chimera {

inline constexpr std::uint32_t kSlots = 4;
/// Groups, tasks and records begin on a line of the cache where several threads use them.
inline constexpr std::size_t kCacheLine = mechanisms::kCopies ? 64 : 8;
/// Offset of the header of a group without copies (plain_group.h).
inline constexpr std::size_t kPlainHead = 8;
inline constexpr std::uint32_t kReadTries = 4;
/// Offset, from the start of a group, of the number of its last publication of initial values.
inline constexpr std::size_t kInitialAt = 8;

/// Every value begins at a multiple of this in the payload of its group.
inline constexpr std::uint32_t kValueAlignment = 8;

/// The bytes that a value of `bytes` takes in a payload. Context: any; wait-free.
constexpr std::uint32_t round_to_value(std::uint32_t bytes) noexcept {
  return (bytes + kValueAlignment - 1) / kValueAlignment * kValueAlignment;
}

/// Bytes from one slot to the next for `payload_bytes` of values. Context: any; wait-free.
constexpr std::size_t slot_stride(std::size_t payload_bytes) noexcept {
  return (sizeof(chimera_slot) + payload_bytes + kCacheLine - 1) / kCacheLine * kCacheLine;
}

/// Bytes of a whole group. Context: any; wait-free.
constexpr std::size_t group_bytes(std::size_t payload_bytes) noexcept {
  if constexpr (!mechanisms::kCopies) return kPlainHead + sizeof(chimera_slot) + 2 * payload_bytes;
  return kCacheLine + kSlots * slot_stride(payload_bytes);
}

}  // namespace chimera
