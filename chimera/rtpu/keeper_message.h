// SPDX-License-Identifier: Apache-2.0
// Messages between the keeper and its children: docs/formats/processes.md, "Keeper messages".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/time.h"

namespace chimera {

/// Descriptors of a child at its start. The keeper's channel is the only one that is not a mapping.
enum : int {
  kChannelDescriptor = 3,
  kImageDescriptor = 4,
  kDecisionPageDescriptor = 5,
  kKeeperPageDescriptor = 6,
  kObjectsDescriptor = 7,    ///< rtpus only: load/sealed_objects.h
  kListeningDescriptor = 7,  ///< manager only: the subsystem's socket
  kBundleDescriptor = 8,     ///< manager only: description, descriptors and rtpus, as read at the start
};

struct KeeperMessage {
  enum class Kind : std::uint32_t {
    kSegment, kStart, kEndChild, kEnd,                        // to the keeper
    kPeer, kStarted, kEnded, kComplete, kFinish,              // from the keeper
    kBeat,                                                    // to the keeper: the manager's loop runs
    kHung,                                                    // from the keeper: the manager's loop hung
    kFramesWritten, kSilent                                   // from the keeper: actions of the guard
  };

  Kind kind = Kind::kSegment;
  std::uint32_t index = 0;        ///< the peer that the message is about
  std::uint32_t incarnation = 0;
  std::int32_t code = 0;          ///< kEnded: exit status or signal; kEnd: exit code; kHung: Life; kSilent: the task;
                                  ///< kFramesWritten: number written
  std::uint32_t by_signal = 0;    ///< kEnded
  std::uint32_t core_dumped = 0;  ///< kEnded
  std::int32_t pid = 0;           ///< kStarted: for people; kHung: pid of the debugger
  std::uint32_t late = 0;         ///< kFramesWritten: number left out, GuardMessage::late
  Nanoseconds at = {};          ///< kStarted, kEnded: instant, CLOCK_MONOTONIC; kFramesWritten: last byte taken
  Nanoseconds silent = {};      ///< kHung: time without a beat; kFramesWritten: instant of the death
  std::uint32_t letter = 0;     ///< kHung: ProcessState::letter; kFramesWritten: number that failed
  std::uint32_t was_ended = 0;  ///< kHung: 1: the keeper killed it; 0: it runs again
  std::uint64_t unused = 0;
};
static_assert(sizeof(KeeperMessage) == 64 && std::is_trivially_copyable_v<KeeperMessage>);

inline std::span<const std::byte> bytes_of(const KeeperMessage& message) noexcept {
  return std::as_bytes(std::span(&message, 1));
}
inline std::span<std::byte> bytes_of(KeeperMessage& message) noexcept {
  return std::as_writable_bytes(std::span(&message, 1));
}

}  // namespace chimera
