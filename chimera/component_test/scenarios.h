// SPDX-License-Identifier: Apache-2.0
// The actions of the child on the component. All results go into the record.
#pragma once

#include "chimera/component_test/single_task.h"

namespace chimera::component_test {

/// The data of a scenario. All of it must outlive the scenario.
struct Scenario {
  const LibraryEntry& entry;
  const Configuration& configuration;
  const InputForm& form;
  const Inputs& inputs;
  const SharedRecord& record;
};

/// Runs all rows, one cycle each, from spawn to kill. Counts the calls of the methods to the heap. Context: a child;
/// may block.
void run_inputs(const Scenario& scenario);
/// Runs a fault in each method, bad inputs of each kind, and repeated spawn and kill. `good` are the rows that were
/// accepted before. Context: a child; may block.
void run_faults(const Scenario& scenario, std::span<const RowRecord> good);

}  // namespace chimera::component_test
