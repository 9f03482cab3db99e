// SPDX-License-Identifier: Apache-2.0
// A component with a counter around each of its methods, and with faults on demand. The framework treats it as the
// component itself. Only one may exist in a process.
#pragma once

#include "chimera/component_test/record.h"
#include "chimera/platform/cycle_counter.h"
#include "chimera/task/abi.h"

namespace chimera::component_test {

/// Context: setup; the methods of component(): as those of the component.
class InstrumentedComponent {
 public:
  /// `real` and `record` must outlive it.
  InstrumentedComponent(const chimera_component& real, Record& record);
  InstrumentedComponent(const InstrumentedComponent&) = delete;
  InstrumentedComponent& operator=(const InstrumentedComponent&) = delete;
  ~InstrumentedComponent();

  const chimera_component& component() const noexcept { return wrapped_; }
  bool has(std::uint32_t method) const noexcept { return real_.methods[method] != nullptr; }
  /// The next call of `method` runs and then returns a fault.
  void fail_next(std::uint32_t method) noexcept { fails_[method] = true; }
  /// True if that call has happened.
  bool has_failed(std::uint32_t method) const noexcept { return !fails_[method]; }
  /// The time of the last call of the method cycle, including the cost of measuring.
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
