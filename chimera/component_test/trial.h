// SPDX-License-Identifier: Apache-2.0
// Runs one component alone, several times, each time in its own process, so that a crash becomes a line of the report.
//
//   counted    all rows; counts the calls of its methods to the heap and, traced, to the system
//   timed      the same rows again, untraced, three times; the outputs must be the same. The least time of each cycle
//              counts, which excludes other work of the machine
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

/// The end of a scenario.
struct PlayEnd {
  ProcessEnd process;
  bool has_hung = false;  ///< no progress for TrialOptions::patience

  bool is_clean() const noexcept { return !has_hung && !process.by_signal && process.code == 0; }
};

struct TrialOptions {
  Nanoseconds patience = seconds(10);  ///< a method that takes longer hangs
  std::string folder;                  ///< base of relative paths of resources; empty: the present folder
};

/// All results about a component.
struct Trial {
  Trial(std::size_t rows, std::size_t payload) : counted(rows, payload), timed(rows, payload), troubled(1, payload) {}

  SharedRecord counted, timed, troubled;
  std::vector<std::int64_t> times_ns;  ///< of all completed cycles of all timed runs, without the first tenth of each
  PlayEnd counted_end, timed_end, troubled_end;
};

/// Runs the component of `entry` in `configuration`. Refuses if the system cannot start a process. Requires: the caller
/// has one thread. Context: setup; may block.
Result<Trial> run_trial(const LibraryEntry& entry, const Configuration& configuration, const InputForm& form,
                        const Inputs& inputs, const TrialOptions& options);

/// The descriptor of the only component of a shared object, read in its own process. Refuses like SharedObject and
/// describe(), and refuses an object that kills the process. Context: setup; may block.
Result<std::string> descriptor_text(const std::string& object_file, const TrialOptions& options);

}  // namespace chimera::component_test
