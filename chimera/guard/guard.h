// SPDX-License-Identifier: Apache-2.0
// The process that writes the safe frames of dead rtpus: docs/design/guard.md and docs/formats/processes.md, "The
// guard". It runs no code of a component and outlives the keeper.
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
#include "chimera/runtime/job/silence.h"

namespace chimera {

/// Number of silent periods of a task after which the guard ends its rtpu. Without a limit it waits for the death of
/// the rtpu.
struct SilenceLimit {
  TaskId task;
  std::uint32_t periods = 0;
};

/// All its memory is allocated at the start; later it allocates nothing. Single-threaded.
class Guard {
 public:
  /// `image` as the keeper made it; it outlives the guard. A standby may state a silence limit: the guard then also
  /// ends the rtpu of its silent primary, while the standby can take over. Refuses a limit of an unknown task, and
  /// every refusal of the layouts. Context: setup.
  static Result<std::unique_ptr<Guard>> create(Channel keeper, const ApplicationImage& image,
                                               std::span<const SilenceLimit> limits);
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  /// Bytes that it maps later, at most. Context: setup.
  std::uint64_t room() const noexcept;
  /// Reports to the keeper that it watches, and whether it has the requested rights. Context: setup.
  void say_ready(bool has_rights) noexcept;
  /// One round: waits until a message or a death arrives, a step is due, or `at_most` is over, and handles it. False
  /// when the keeper is gone, no rtpu lives and no frame is left to write. Context: any; blocks.
  bool step(Nanoseconds at_most = kNever) noexcept;

 private:
  struct Life {
    OwnedDescriptor process;  // readable when the rtpu is dead; -1: none lives
    Channel line;
    PeerSegment segment;
    std::uint32_t incarnation = 0;
  };
  struct Rtpu {
    Life life;
    Life next;  // the successor, if the keeper has started it before the guard saw the death
    bool is_writing = false;
    std::uint32_t written_of = 0;  // the incarnation that died last
    Nanoseconds died{};
  };
  Guard(Channel keeper, const ApplicationImage& image);
  Result<void> prepare(std::span<const SilenceLimit> limits);
  void wait(Nanoseconds at_most) noexcept;
  void listen_to_keeper() noexcept;
  void take(const GuardMessage& message, OwnedDescriptor passed) noexcept;
  void listen_to(Life& life, std::uint32_t index) noexcept;
  bool listen_once(Life& life, std::uint32_t index) noexcept;
  void open_segment(Life& life, std::uint32_t index, int descriptor) noexcept;
  void bury(std::uint32_t index) noexcept;
  void finish(std::uint32_t index, bool is_at_once = false) noexcept;
  void look_for_silence() noexcept;
  bool is_there(std::uint32_t index) const noexcept;
  TaskStatus status(TaskId task) const noexcept;
  void tell(GuardMessage message) noexcept;
  void tell_unguarded(std::uint32_t index, std::uint32_t incarnation, int error) noexcept;
  bool is_needed() const noexcept;

  Channel keeper_;
  const ApplicationSpec& spec_;
  LinuxClock clock_;
  HeapMemory memory_;  // memory of the layouts
  std::vector<PeerLayout> layouts_;
  std::vector<Rtpu> rtpus_;
  SafeWrites writes_;
  std::vector<Silence> silences_;
};

}  // namespace chimera
