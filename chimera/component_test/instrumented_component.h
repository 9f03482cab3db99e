// SPDX-License-Identifier: Apache-2.0
// A component with a counter before and behind each of its methods, and faults on demand: to the framework it is the
// component itself. One at a time in a process.
#pragma once

#include "chimera/component_test/record.h"
#include "chimera/platform/cycle_counter.h"
#include "chimera/task/abi.h"

namespace chimera::component_test {

/// Context: setup; the methods of component(): those of the component.
class InstrumentedComponent {
 public:
  /// `real` and `record` outlive it.
  InstrumentedComponent(const chimera_component& real, Record& record);
  InstrumentedComponent(const InstrumentedComponent&) = delete;
  InstrumentedComponent& operator=(const InstrumentedComponent&) = delete;
  ~InstrumentedComponent();

  const chimera_component& component() const noexcept { return wrapped_; }
  bool has(std::uint32_t method) const noexcept { return real_.methods[method] != nullptr; }
  /// The next call of `method` answers with a fault, after it has run.
  void fail_next(std::uint32_t method) noexcept { fails_[method] = true; }
  /// True when that call was made since.
  bool has_failed(std::uint32_t method) const noexcept { return !fails_[method]; }
  /// Time that the method cycle took when it was called last, with that of measuring.
  Nanoseconds cycle_time() const noexcept { return cycle_time_; }

  std::int32_t call(std::uint32_t method, void* state, const chimera_call* call) noexcept;

 private:
  void measure_measuring() noexcept;

  const chimera_component& real_;
  Record& record_;
  chimera_component wrapped_{};
  CycleCounter clock_ = CycleCounter::calibrate();
  bool fails_[CHIMERA_METHODS] = {};
  Nanoseconds cycle_time_;
};

}  // namespace chimera::component_test
