// SPDX-License-Identifier: Apache-2.0
// What the child does with the component. Everything it finds out goes into the record.
#pragma once

#include "chimera/component_test/single_task.h"

namespace chimera::component_test {

/// What is played, and on what. Everything outlives the scenario.
struct Scenario {
  const LibraryEntry& entry;
  const Configuration& configuration;
  const InputForm& form;
  const Inputs& inputs;
  const SharedRecord& record;
};

/// All rows, one cycle each, from spawn to kill. Counts what the methods ask of the heap. Context: a child; may block.
void run_inputs(const Scenario& scenario);
/// A fault in each method, bad inputs of each kind, and spawn and kill again and again. `good` says which rows were
/// accepted before. Context: a child; may block.
void run_faults(const Scenario& scenario, std::span<const RowRecord> good);

}  // namespace chimera::component_test
