// SPDX-License-Identifier: Apache-2.0
// Toys run by the preemptive executor with real-time levels, on the last CPU.
#pragma once

#include <span>
#include <thread>
#include <vector>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/runner.h"
#include "tests/conformance/witness.h"

namespace chimera::toy {

inline constexpr int kCeiling = 49;

/// Every level is looked up in the kernel.
inline ProcessorPlace checked_place() {
  ProcessorPlace place;
  place.cpu = last_cpu();
  place.ceiling = kCeiling;
  place.base = 30;
  place.checks = true;
  return place;
}

/// Runs `edges` to its end in a thread at the ceiling: who takes the edges of a context.
template <class Edges>
void at_the_ceiling(Edges edges) {
  std::thread thread([&edges] {
    (void)enter_realtime({kCeiling, last_cpu(), false});
    edges();
  });
  thread.join();
}

/// What a run left; the profiles are in the tasks.
struct Left {
  std::vector<TapRecord> records;
  Nanoseconds origin;
  ProcessorCounts counts;
};

/// Runs the tasks of `app` for `time`.
inline Left run_by_threads(Application& app, Policy policy, Nanoseconds time,
                           const ProcessorPlace& place = checked_place(), std::span<const ScriptAct> acts = {}) {
  Listened listened;
  RunOptions options;
  options.policy = policy;
  options.script = Script(acts);
  options.tap = listened.tap();
  PreemptiveExecutor executor(app.build_preemptive(), options, place);
  at_the_ceiling([&] {
    if (executor.start()) executor.run(time);
  });
  return {listened.records(), executor.origin(), executor.counts()};
}

}  // namespace chimera::toy
