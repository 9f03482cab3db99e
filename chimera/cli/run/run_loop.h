// SPDX-License-Identifier: Apache-2.0
// The two ways to run an application, seen alike: in slices up to an instant since the start.
#pragma once

#include <memory>

#include "chimera/cli/run/run.h"
#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/hosted/asked_sets.h"

namespace chimera::cli {

/// Context: setup thread. Only one at a time per application.
class RunLoop {
 public:
  virtual ~RunLoop() = default;
  /// Spawns the tasks and turns the start set ON; real time: from now on they run.
  virtual Result<void> start() = 0;
  /// Lets the run come to `until` (since its origin) or to its end; nullopt: it goes on.
  virtual std::optional<RunEnd> advance(Nanoseconds until) = 0;
  /// Since the origin.
  virtual Nanoseconds now() const = 0;
  virtual Nanoseconds origin() const = 0;
  virtual void shut_down() = 0;
  /// Signals refused during the run; after the end only.
  virtual std::span<const RefusedSignal> refused() = 0;
  /// Receipts of the requested switches; after the end only.
  virtual const SwitchReceipts& receipts() = 0;
  /// One line about how it is run, for people.
  virtual std::string description() const = 0;
};

/// "refused at 0.200 s: off pid: ..." and a line end, of each signal of the script and of tasks that was refused, and
/// of the lists of tasks that led to no legal set, in order of time. Context: setup, after the end.
std::vector<std::string> refused_lines(RunLoop& loop, std::span<const Task* const> tasks, const AskedSets& asked,
                                       const ApplicationSpec& spec);
/// The task whose reaction `stop` ended it: the first failure of time with that; "" when there is none.
std::string who_stopped(std::span<const Task* const> tasks);

/// With a context for each rtpu: each by its own policy, and preemptive when it says so or the request does. One
/// context follows the rtpu of the first task; in real time it follows the first rtpu.
std::unique_ptr<RunLoop> make_virtual_loop(Application& application, const RunRequest& request, RunOptions options);
std::unique_ptr<RunLoop> make_real_time_loop(Application& application, const RunRequest& request, RunOptions options);

}  // namespace chimera::cli
