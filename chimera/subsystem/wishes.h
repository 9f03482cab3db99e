// SPDX-License-Identifier: Apache-2.0
// Who waits for a transaction: goals first, then faces and tasks in their order.
#pragma once

#include <deque>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/situation.h"
#include "chimera/subsystem/transaction.h"

namespace chimera::subsystem {

/// Context: setup.
class Wishes {
 public:
  Wishes(Situation& situation, Goals& goals, Transaction& transaction)
      : at_(situation), goals_(goals), transaction_(transaction) {}

  void add(const Commanded& command);
  /// The same request while it waits is one: a task may send at every cycle. Of a task that does not exist: none.
  void add(const Requested& request);
  /// Begins the next transaction when none is under way.
  void advance();
  Nanoseconds next_due() const noexcept;

 private:
  struct Waiting {
    OnWish wish;
    Nanoseconds arrived;
    bool has_waited = false;  // for goals of its tasks
  };
  bool begin_goals();
  bool try_begin(Waiting& waiting);
  bool must_wait(const std::vector<TaskId>& tasks) const;
  Nanoseconds due(const Waiting& waiting) const noexcept;
  bool are_all_on(const std::vector<TaskId>& tasks) const noexcept;
  void accept(const Waiting& waiting) const;

  Situation& at_;
  Goals& goals_;
  Transaction& transaction_;
  std::deque<Waiting> queue_;
};

}  // namespace chimera::subsystem
