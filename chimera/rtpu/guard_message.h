// SPDX-License-Identifier: Apache-2.0
// Messages between the keeper, the rtpus and the guard: docs/formats/processes.md, "The guard".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/time.h"

namespace chimera {

/// Descriptors of the guard at its start.
inline constexpr int kGuardChannelDescriptor = 3, kGuardImageDescriptor = 4, kGuardDecisionDescriptor = 5;
/// Descriptor of an rtpu: its end of the channel to the guard; it follows those of keeper_message.h.
inline constexpr int kRtpuGuardDescriptor = 8;

struct GuardMessage {
  enum class Kind : std::uint32_t {
    kRtpu,     ///< keeper -> guard, with a pidfd: rtpu `index` lives in `incarnation`; a kLine follows
    kLine,     ///< keeper -> guard, with the guard's end of the channel to that rtpu
    kSegment,  ///< rtpu -> guard, with its memory
    kFrame,    ///< rtpu -> guard, with a descriptor: frame `frame` of `task` goes there; without one: it goes nowhere
    kReady,    ///< guard -> keeper: it watches; `good` 1: with the requested rights
    kUnguarded,  ///< guard -> keeper: it cannot write the frames of rtpu `index`; `bad` is the errno
    kWritten,  ///< guard -> keeper: rtpu `index` is dead; `good` of its frames were written, `bad` failed, `late` were
               ///< left out because its successor drives the device
    kSilent    ///< guard -> keeper: it ended rtpu `index` because `task` published nothing for too long; `good` 1: a
               ///< standby takes over
  };

  Kind kind = Kind::kRtpu;
  std::uint32_t index = 0;
  std::uint32_t incarnation = 0;
  std::uint32_t task = 0;
  std::uint32_t frame = 0;
  std::uint32_t good = 0, bad = 0;
  std::uint32_t late = 0;
  Nanoseconds pause = {};  ///< kFrame: time without traffic before the frame
  Nanoseconds died = {};   ///< kWritten: when the guard saw the death, CLOCK_MONOTONIC
  Nanoseconds at = {};     ///< kWritten: when the device accepted the last byte
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
