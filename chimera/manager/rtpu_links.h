// SPDX-License-Identifier: Apache-2.0
// The real-time units as the manager deals with them: takes their posts and looks at their words, and makes events of
// both; posts signals to them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

using Events = std::vector<subsystem::Event>;

/// Context: setup; never blocks.
class RtpuLinks {
 public:
  explicit RtpuLinks(ManagerState& world);

  /// The keeper says that an incarnation lives.
  void started(const KeeperMessage& message);
  /// The segment of an incarnation, alive or not. What is no segment of it is told and left out.
  void mapped(const KeeperMessage& message, int descriptor);
  /// It is dead: its last words and posts, then RtpuDown.
  void ended(const KeeperMessage& message, Events& events);

  /// Everything that changed: who serves now, posts, status words.
  void look(Events& events);
  /// The counters of failures, one event for a task and kind.
  void look_at_counters(Nanoseconds at);
  /// Does every living rtpu serve this manager?
  bool all_up() const noexcept;

  /// Posts the signals as one transaction, all or none; false when there is no room or no reader.
  bool send(const subsystem::Send& send, Nanoseconds at);
  /// Rings the doorbell of each task, as often as it is named, all or none; the rtpu that has no room or does not read
  /// when it was none, else invalid.
  RtpuId ring(std::span<const TaskId> tasks, Nanoseconds at);

 private:
  struct Counted {
    std::uint64_t missed = 0, overrun = 0, stale = 0;
    bool is_untrue = false;  ///< told
  };
  struct Link {
    Inbox inbox;
    Outbox outbox;
    std::vector<TaskId> tasks;
    std::uint64_t lost = 0;
    bool has_died = false;  ///< an incarnation before, as far as this manager knows; until the next one is up
  };

  RtpuRecord& record(RtpuId rtpu) noexcept { return world_.rtpus[rtpu.index]; }
  bool is_current(RtpuId rtpu) const noexcept;
  bool is_switch_open_beside(RtpuId rtpu) const noexcept;
  bool has_room(RtpuId rtpu, std::size_t posts) const noexcept;
  void take_posts(RtpuId rtpu, Events& events);
  void take(const Post& post, RtpuId rtpu, Events& events);
  void see(TaskId task, Events& events, bool always = false);
  void log(const Post& post, RtpuId rtpu);
  void tell_not_off(TaskId task, Method method, RtpuId rtpu, Nanoseconds at);
  void count(TaskId task, Nanoseconds at);
  std::string what_it_made(RtpuId rtpu) const;

  ManagerState& world_;
  std::vector<Link> links_;
  std::vector<TaskStatus> seen_;
  std::vector<Counted> counted_;
};

}  // namespace chimera::manager
