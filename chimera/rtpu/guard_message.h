// SPDX-License-Identifier: Apache-2.0
// What the keeper, the real-time units and the guard say to each other: docs/formats/processes.md, "The guard".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/time.h"

namespace chimera {

/// Descriptors of the guard at its start.
inline constexpr int kGuardChannelDescriptor = 3, kGuardImageDescriptor = 4;
/// Of a real-time unit: its end of the channel to the guard; behind those of keeper_message.h.
inline constexpr int kUnitGuardDescriptor = 8;

struct GuardMessage {
  enum class Kind : std::uint32_t {
    kUnit,     ///< keeper -> guard, with a pidfd: unit `index` lives in `incarnation`; a kLine follows
    kLine,     ///< keeper -> guard, with the guard's end of the channel to that unit
    kSegment,  ///< unit -> guard, with its memory
    kFrame,    ///< unit -> guard, with a descriptor: frame `frame` of `task` goes there; without: nowhere any more
    kReady,    ///< guard -> keeper: it watches; `good` 1: with the rights that were asked for
    kWritten,  ///< guard -> keeper: unit `index` is dead; `good` of its frames were written, `bad` could not be
    kSilent    ///< guard -> keeper: it ended unit `index`, because `task` had published nothing for too long; `good` 1:
               ///< so that a standby takes over
  };

  Kind kind = Kind::kUnit;
  std::uint32_t index = 0;
  std::uint32_t incarnation = 0;
  std::uint32_t task = 0;
  std::uint32_t frame = 0;
  std::uint32_t good = 0, bad = 0;
  std::uint32_t reserved = 0;
  Nanoseconds pause = {};  ///< kFrame: the line rests for so long before
  Nanoseconds died = {};   ///< kWritten: when the death was seen, CLOCK_MONOTONIC
  Nanoseconds at = {};     ///< kWritten: when the last byte was taken
  std::uint64_t unused = 0;
};
static_assert(sizeof(GuardMessage) == 64 && std::is_trivially_copyable_v<GuardMessage>);

inline std::span<const std::byte> bytes_of(const GuardMessage& message) noexcept {
  return std::as_bytes(std::span(&message, 1));
}
inline std::span<std::byte> bytes_of(GuardMessage& message) noexcept {
  return std::as_writable_bytes(std::span(&message, 1));
}

}  // namespace chimera
