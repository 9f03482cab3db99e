// SPDX-License-Identifier: Apache-2.0
// One task alone under the framework, in virtual time. The test controls its inputs, its releases and its signals. Only
// for the child.
#pragma once

#include <memory>
#include <string>

#include "chimera/base/result.h"
#include "chimera/catalogue/library.h"
#include "chimera/component_test/inputs.h"
#include "chimera/component_test/instrumented_component.h"
#include "chimera/component_test/record.h"
#include "chimera/load/shared_object.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera::component_test {

/// Context: setup.
class SingleTask {
 public:
  /// Opens the object and makes the task, in NOT-CREATED. All arguments must outlive it. Refuses like SharedObject and
  /// TaskSet.
  static Result<std::unique_ptr<SingleTask>> create(const LibraryEntry& entry, const Configuration& configuration,
                                                    const InputForm& form, Record& record);

  State state() const noexcept { return task().state; }
  const Task& task() const noexcept { return set_->tasks()[0]; }
  InstrumentedComponent& component() noexcept { return *component_; }
  /// The text of the last fault.
  const char* fault_text() const noexcept { return task().faults.last.text; }

  /// Publishes a row of inputs.
  void feed(std::span<const std::byte> row) noexcept;
  /// Sends a signal; returns the state afterwards.
  State signal(Signal signal);
  /// Sets the illegal-configuration flag for the following cycles.
  void raise_flag(bool is_up) noexcept { set_->flag().raise(is_up); }
  /// Releases the task once, a period after the last release, and runs its cycle and background. Requires: ON.
  RowRecord cycle() noexcept;
  /// Copies the published outputs, in the layout of output_places().
  void copy_outputs(std::span<std::byte> to) const noexcept;
  /// Copies the number of elements in use of each output.
  void copy_counts(std::span<std::uint32_t> to) const noexcept;

 private:
  SingleTask(SharedObject object, const Configuration& configuration, const InputForm& form, Record& record)
      : object_(std::move(object)), configuration_(configuration), form_(form), record_(record) {}
  Result<void> build(const LibraryEntry& entry);

  SharedObject object_;
  Configuration configuration_;
  const InputForm& form_;
  Record& record_;
  ModelledClock clock_;
  Nanoseconds now_;
  std::unique_ptr<InstrumentedComponent> component_;
  std::unique_ptr<HeapTaskSet> set_;
  std::vector<OutputPlace> places_;
};

}  // namespace chimera::component_test
