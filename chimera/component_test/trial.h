// SPDX-License-Identifier: Apache-2.0
// One component alone: run again and again, each time in a process of its own, so that its crash is a line of the
// report.
//
//   counted    all rows; what its methods ask of the heap and, traced, of the system
//   timed      the same rows again, untraced, three times; the same outputs are expected. The least time of each cycle
//              counts: what the machine did meanwhile is not the component's
//   troubled   a fault in each method, bad inputs, spawn and kill again
#pragma once

#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/catalogue/library.h"
#include "chimera/component_test/inputs.h"
#include "chimera/component_test/record.h"
#include "chimera/platform/process.h"

namespace chimera::component_test {

/// How a scenario ended.
struct PlayEnd {
  ProcessEnd process;
  bool has_hung = false;  ///< nothing happened for TrialOptions::patience

  bool is_clean() const noexcept { return !has_hung && !process.by_signal && process.code == 0; }
};

struct TrialOptions {
  Nanoseconds patience = seconds(10);  ///< a method that takes longer hangs
  std::string folder;                  ///< that relative paths of resources start from; empty: the present one
};

/// Everything that was found out about a component.
struct Trial {
  Trial(std::size_t rows, std::size_t payload) : counted(rows, payload), timed(rows, payload), troubled(1, payload) {}

  SharedRecord counted, timed, troubled;
  std::vector<std::int64_t> times_ns;  ///< of every completed cycle of all timed plays but the first tenth of each
  PlayEnd counted_end, timed_end, troubled_end;
};

/// Runs the component of `entry` as `configuration` says. Refuses when the system gives no process. Call it with one
/// thread. Context: setup; may block.
Result<Trial> run_trial(const LibraryEntry& entry, const Configuration& configuration, const InputForm& form,
                        const Inputs& inputs, const TrialOptions& options);

/// The descriptor of the one component that a shared object offers, asked in a process of its own. Refuses, as
/// SharedObject and describe() do, what is no component, and one that dies of it. Context: setup; may block.
Result<std::string> descriptor_text(const std::string& object_file, const TrialOptions& options);

}  // namespace chimera::component_test
