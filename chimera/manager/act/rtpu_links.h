// SPDX-License-Identifier: Apache-2.0
// The rtpus as the manager handles them: it reads their posts and words, makes events of both, and posts signals to
// them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

using Events = std::vector<subsystem::Event>;

/// Context: setup; never blocks.
class RtpuLinks {
 public:
  explicit RtpuLinks(ManagerState& state);

  /// The keeper reports that an incarnation lives.
  void started(const KeeperMessage& message);
  /// Maps the segment of an incarnation, alive or dead. Logs and ignores memory that is not its segment.
  void mapped(const KeeperMessage& message, int descriptor);
  /// The incarnation is dead: appends events for its last words and posts, then RtpuDown.
  void ended(const KeeperMessage& message, Events& events);

  /// Reads all that changed: rtpus that serve now, posts, status words.
  void look(Events& events);
  /// Reads the counters of failures; logs one event for a task and kind.
  void look_at_counters(Nanoseconds at);
  /// True if every living rtpu serves this manager.
  bool all_up() const noexcept;

  /// Posts the signals as one transaction, all or none. False if there is no room or no reader.
  bool send(const subsystem::Send& send, Nanoseconds at);
  /// Rings the doorbell of each task, as often as it is named, all or none. If none, returns the rtpu that has no room
  /// or does not read; otherwise invalid.
  RtpuId ring(std::span<const TaskId> tasks, Nanoseconds at);

 private:
  struct Counted {
    std::uint64_t missed = 0, overrun = 0, stale = 0;
  };
  struct Link {
    Inbox inbox;
    Outbox outbox;
    std::vector<TaskId> tasks;
    std::uint64_t lost = 0;
    bool has_died = false;  ///< an earlier incarnation died, as far as this manager knows; until the next one serves
  };

  RtpuRecord& record(RtpuId rtpu) noexcept { return state_.rtpus[rtpu.index]; }
  bool is_current(RtpuId rtpu) const noexcept;
  bool believes(RtpuId rtpu);
  std::string wrong_word(RtpuId rtpu) const;
  std::string wrong_count(RtpuId rtpu, Nanoseconds at) const;
  void disbelieve(RtpuId rtpu, std::string_view why);
  bool is_switch_open_beside(RtpuId rtpu) const noexcept;
  bool has_room(RtpuId rtpu, std::size_t posts) const noexcept;
  void take_posts(RtpuId rtpu, Events& events);
  void take(const Post& post, RtpuId rtpu, Events& events);
  void see(TaskId task, Events& events, bool always = false);
  void log(const Post& post, RtpuId rtpu);
  void tell_not_off(TaskId task, Method method, RtpuId rtpu, Nanoseconds at);
  void count(TaskId task, Nanoseconds at);
  std::string what_it_made(RtpuId rtpu) const;

  ManagerState& state_;
  std::vector<Link> links_;
  std::vector<TaskStatus> seen_;
  std::vector<Counted> counted_;
};

}  // namespace chimera::manager
