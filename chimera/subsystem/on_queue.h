// SPDX-License-Identifier: Apache-2.0
// Requests for `on` that wait for a transaction: goals first, then those of clients and tasks in the order of arrival.
#pragma once

#include <deque>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/on_transaction.h"
#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// Context: setup.
class OnQueue {
 public:
  OnQueue(SubsystemState& state, Goals& goals, OnTransaction& transaction)
      : state_(state), goals_(goals), transaction_(transaction) {}

  void add(const Commanded& command);
  /// Adds a request. A request that already waits is not added again, because a task may send one at every cycle. A
  /// request for an unknown task is dropped.
  void add(const Requested& request);
  /// Begins the next transaction if none is under way. False if nothing changed.
  bool advance();
  Nanoseconds next_due() const noexcept;

 private:
  struct Waiting {
    OnRequest request;
    Nanoseconds arrived;
    bool has_waited = false;  // it waited for goals of its tasks
  };
  bool fail_lost_goals();
  bool is_replaced(TaskId task) const noexcept;
  bool try_begin_goals();
  void begin(OnRequest request);
  bool try_begin(Waiting& waiting);
  bool must_wait(const std::vector<TaskId>& tasks) const;
  Nanoseconds due(const Waiting& waiting) const noexcept;
  bool are_all_on(const std::vector<TaskId>& tasks) const noexcept;
  void accept(const Waiting& waiting) const;

  SubsystemState& state_;
  Goals& goals_;
  OnTransaction& transaction_;
  std::deque<Waiting> queue_;
};

}  // namespace chimera::subsystem
