// SPDX-License-Identifier: Apache-2.0
// The processes that a keeper adopted: what components started and left behind, and memory holders.
// docs/formats/processes.md, "What components start".
#pragma once

#include <sys/types.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"

namespace chimera {

/// Single-threaded. Context: setup; never blocks but in end_all().
class Orphans {
 public:
  /// Adopts from here on what loses its parent. A child that this process has already is not its own and is left alone:
  /// it was somebody else's before this program began in the same process.
  Orphans();

  /// What every origin of this keeper's begins with: no other process ever has it.
  const std::string& prefix() const noexcept { return prefix_; }

  /// Reaps each child that has ended and is not among `held`: those of which somebody has a Process. Sends SIGKILL to
  /// each that comes from a unit that does not live, to a memory holder 100 ms after it was first seen. One whose
  /// origin is not known is left until the end. `lives`: whether the unit of that origin does.
  void look(std::span<const pid_t> held, const std::function<bool(std::string_view)>& lives, Nanoseconds now);
  /// When there is something to look at though nothing happens; kNever: no such thing.
  Nanoseconds due() const noexcept { return due_; }

  /// When everybody else has ended: SIGKILL for all of them, and for what becomes a child by that, until none is left.
  /// Memory holders have 100 ms to end by themselves. Whoever else is left after `limit` is named on stderr.
  void end_all(Nanoseconds limit);

 private:
  struct Seen {
    pid_t pid;
    Nanoseconds at;
  };
  bool has_time(pid_t pid, Nanoseconds now);
  bool is_ours(pid_t pid, Nanoseconds now, bool& is_doubtful);
  Nanoseconds first_seen(pid_t pid, Nanoseconds now);
  std::vector<pid_t> living(std::span<const pid_t> held);

  std::string prefix_;
  std::vector<pid_t> strangers_;
  std::vector<Seen> seen_;
  Nanoseconds due_ = kNever;
};

}  // namespace chimera
