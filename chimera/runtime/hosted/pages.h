// SPDX-License-Identifier: Apache-2.0
// The two small pages that every process of a subsystem maps. docs/formats/processes.md.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/runtime/plan/switch_agreement.h"

namespace chimera {

inline constexpr std::uint32_t kMaxRtpus = 16;             // description/draft.cc refuses more
inline constexpr std::size_t kMaxGroups = 256;            // an image has no more standbys
inline constexpr std::uint32_t kMaxPeers = kMaxRtpus + 1;  // the manager is peer number n_rtpus

/// One word on a cache line of its own, so that ringing one bell does not slow the reader of another.
/// Doorbell::ring() adds one with release; Doorbell::read() and BoundaryListener::listen() load with acquire: what was
/// stored before the ring is seen after it.
struct alignas(64) BellWord {
  std::atomic<std::uint32_t> word{0};
};

/// Writable by all processes. Its words only decide when a process checks for news.
struct DecisionPage {
  BellWord bells[kMaxPeers];  ///< one for each peer
  /// Counted up after every change of a status word, of the living peers, or of a request of the manager: with release.
  /// A process that then checks those words loads it with acquire.
  alignas(64) std::atomic<std::uint32_t> changes{0};
  /// By peer: what it makes before it shows a block of its own, as show_making() writes it. Relaxed, pairs with
  /// nothing: read when the peer is dead or hangs.
  alignas(64) std::atomic<std::uint32_t> making[kMaxPeers];
  /// By group of standbys (runtime/plan/standbys.h): the rtpu that is about to turn one of its tasks ON. Bits 32-63:
  /// its number plus 1; bits 0-31: its incarnation; 0: none. Compare-and-swap, acq_rel: the new holder of the claim
  /// sees the status words that the holder before has stored. A claim of a dead process is free.
  alignas(64) std::atomic<std::uint64_t> claims[kMaxGroups];
  /// Rounds of the guard: four a second, or it hangs. Relaxed, pairs with nothing.
  alignas(64) std::atomic<std::uint64_t> guard_beats{0};
  /// How far a switch of configurations has come. Outlives the manager, which plans.
  SwitchPage switching;
};
static_assert(kMaxRtpus <= kMaxContexts);

enum class GuardState : std::int32_t { kWell, kLate, kDead };  ///< kLate: without real-time rights

/// Writable by the keeper alone. `alive` and `ending` are stored with release and loaded with acquire: what the keeper
/// did before is seen with them. The others are figures that pair with nothing.
struct KeeperPage {
  std::atomic<std::uint64_t> beats{0};  ///< how often the keeper came round: four times a second, or it hangs
  Nanoseconds origin;                   ///< of the grid of releases, CLOCK_MONOTONIC
  std::uint32_t n_rtpus = 0;
  std::atomic<std::uint32_t> ending{0};
  std::atomic<std::uint32_t> alive[kMaxPeers];  ///< incarnation of the peer that lives; 0: none
  // Facts about the process that prints the run, face_page.h: for processes that cannot see its page.
  std::atomic<std::uint32_t> face_deaths{0};
  std::atomic<std::int32_t> face_signal{0};
  std::atomic<std::int32_t> lost_output{0};
  // The guard.
  std::atomic<std::int32_t> guard_pid{0};  ///< 0: there is none
  std::atomic<GuardState> guard_state{GuardState::kWell};
  std::atomic<std::int32_t> unguarded[kMaxRtpus];  ///< errno: why no frame of the rtpu can be written; 0: it can
};

}  // namespace chimera
