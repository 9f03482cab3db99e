// SPDX-License-Identifier: Apache-2.0
// The process that writes the safe frames of real-time units that are dead: docs/design/guard.md and
// docs/formats/processes.md, "The guard". It runs no code of a component and outlives the keeper.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/guard/safe_writes.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/local_socket.h"
#include "chimera/rtpu/guard_message.h"
#include "chimera/runtime/hosted/application_image.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/peer_segment.h"
#include "chimera/runtime/silence.h"

namespace chimera {

/// After how many silent periods the unit of a task is ended; only its death before that when there is none.
struct SilenceLimit {
  TaskId task;
  std::uint32_t periods = 0;
};

/// Everything it works in is made at once: from then on nothing is asked of the heap. Single-threaded.
class Guard {
 public:
  /// `image` as the keeper made it; it outlives the guard. Units of primaries whose standbys say so are ended for their
  /// silence, too, while such a standby can take over. Refuses a limit of a task that there is not, and what the
  /// layouts refuse. Context: setup.
  static Result<std::unique_ptr<Guard>> create(Channel keeper, const ApplicationImage& image,
                                               std::span<const SilenceLimit> limits);
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  /// Tells the keeper that it watches, and whether with the rights that were asked for. Context: setup.
  void say_ready(bool has_rights) noexcept;
  /// One round: waits until something has happened, is due, or `at_most` is over, and deals with it. False when the
  /// keeper is gone, no unit lives and nothing is on its way. Context: any; blocks.
  bool step(Nanoseconds at_most = kNever) noexcept;

 private:
  struct Unit {
    OwnedDescriptor process;  // readable when it is dead; -1: none lives
    Channel line;
    PeerSegment segment;
    std::uint32_t incarnation = 0;
    bool is_writing = false;
    Nanoseconds died{};
  };
  Guard(Channel keeper, const ApplicationImage& image);
  Result<void> prepare(std::span<const SilenceLimit> limits);
  void wait(Nanoseconds at_most) noexcept;
  void listen_to_keeper() noexcept;
  void take(const GuardMessage& message, OwnedDescriptor passed) noexcept;
  void listen_to_unit(std::uint32_t index) noexcept;
  void bury(std::uint32_t index) noexcept;
  void finish(std::uint32_t index, bool is_at_once = false) noexcept;
  void look_for_silence() noexcept;
  bool is_there(std::uint32_t index) const noexcept;
  TaskStatus status(TaskId task) const noexcept;
  void tell(GuardMessage message) noexcept;
  bool is_needed() const noexcept;

  Channel keeper_;
  const ApplicationSpec& spec_;
  LinuxClock clock_;
  HeapMemory memory_;  // behind the layouts
  std::vector<PeerLayout> layouts_;
  std::vector<Unit> units_;
  SafeWrites writes_;
  std::vector<Silence> silences_;
};

}  // namespace chimera
