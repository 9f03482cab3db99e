// SPDX-License-Identifier: Apache-2.0
// The specification of a task for the lower layers: all data to make and run it, without files. Plain data over memory
// that the caller keeps alive (a Configuration, or tables in an image).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/server_spec.h"

namespace chimera {

/// One dimension of a port of this task, after verification.
struct ExtentSpec {
  std::uint32_t max = 1;  ///< storage reserved; the extent itself when `constant` is invalid
  ConstantId constant;    ///< fixes the extent at init, in 1..max
};

/// One port instance of this task, with every unit, extent and type variable solved.
struct PortSpec {
  std::uint32_t declared = 0;   ///< index in the component's declaration
  std::uint32_t kind = CHIMERA_IN_VAR;  ///< as declared
  std::uint32_t instance = 0;   ///< of a repeated port; 0 otherwise
  VariableId variable;          ///< in-var, out-var: the state variable it is linked to; invalid for other kinds
  ConstantId constant;          ///< in-const, out-const: the constant it is linked to; invalid: an in-const of its own
  std::string_view unit;        ///< of the values, as solved; "1" for none; resource: ""
  std::uint32_t element_bytes = 0;
  ExtentSpec extent[CHIMERA_MAX_EXTENTS];
  bool safety = false;
  double min = 0, max = 0;      ///< declared range, in the port's unit; counts when has_range
  bool has_range = false;
  std::uint32_t type = CHIMERA_FLOAT64;  ///< solved element type, never CHIMERA_ANY
  /// out-var: initial value; in-const: the value given to this task alone, else the component's default;
  /// resource: its text without the zero. Empty: none. Values fill all max elements.
  std::span<const std::byte> value;
  /// Number of list entries in the written `value`, by dimension; 0: one value for all elements. An extent that a
  /// constant fixes must agree with them.
  std::uint32_t listed[CHIMERA_MAX_EXTENTS] = {};
  /// out-var: the largest step at a switch of configurations, for each of the max elements, above 0; empty: no limit.
  std::span<const std::byte> max_step;
  bool shared = false;        ///< resource: several tasks may open it together
  bool intermittent = false;  ///< in-var: a set of tasks may lack a producer
  /// Without the index of an instance. Only tables of an image need it, whose components do not declare their ports; an
  /// ApplicationImage does not carry it.
  std::string_view name = {};

  std::uint32_t max_count() const noexcept { return extent[0].max * extent[1].max; }
  std::uint32_t max_bytes() const noexcept { return max_count() * element_bytes; }
};

/// The reactions to a missed deadline or an overrun; chimera/runtime/job/miss_policy.h describes each.
enum class OnMiss : std::uint8_t { kContinue, kHold, kSkip, kAbort, kDemote, kError, kSwitch, kFlag, kStop };

/// The reactions to a fault from which the method error does not recover, so that the task is in ERROR.
enum class OnFault : std::uint8_t {
  kError,   ///< no further action
  kFlag,    ///< the illegal-configuration flag goes up, until the task is no longer in ERROR
  kStop,    ///< the executor stops
  kSwitch,  ///< requests a configuration
  kRestart,  ///< `clear` and `on`, as RestartSpec says (runtime/application_spec.h)
};

/// One task. Times are zero or positive; period > 0.
struct TaskSpec {
  std::string_view name;
  std::string_view component;
  Nanoseconds period;    ///< between releases; an aperiodic task checks for an event at each, unless `has_events`
  Nanoseconds offset;    ///< of the grid of releases: start of the run + offset + k * period, whenever on comes
  Nanoseconds deadline;  ///< relative to the release, 0 < deadline <= period
  Nanoseconds budget;    ///< execution time a cycle may use; 0 = not stated
  Nanoseconds min_time;  ///< execution time a useful cycle needs at least; 0 = not stated
  std::uint32_t criticality = 0;    ///< higher is more critical: low 0, medium 1, high 2
  std::uint32_t user_priority = 0;  ///< higher first
  OnMiss on_miss = OnMiss::kContinue;
  OnMiss on_overrun = OnMiss::kContinue;
  OnFault on_fault = OnFault::kError;
  /// Without a server, events release the jobs of this aperiodic task, at least `period` apart. Only where jobs do not
  /// preempt each other; a preemptive executor polls the task.
  bool has_events = false;
  std::uint32_t max_consecutive = 0;  ///< misses in a row after which the task goes to ERROR; 0 = no limit
  std::uint16_t tolerated_misses = 0;  ///< of the last `tolerated_of` cycles, this number may miss without a reaction
  std::uint16_t tolerated_of = 0;      ///< 0: none; at most 64
  std::uint32_t place = 0;             ///< of two equals released together the lower one runs first, then the index
  std::uint32_t stack_bytes = 0;       ///< of the task's thread, where it has one; 0: the default
  bool aperiodic = false;             ///< the component has a sync method
  bool is_hardware = false;           ///< has a resource port: first to go ON, last to go OFF
  // For reactions `switch`: the number of the configuration; UINT16_MAX for other reactions. These members fill a gap,
  // because a job step multiplies by the size of this struct.
  std::uint16_t on_miss_set = UINT16_MAX;
  RtpuId rtpu;
  std::uint16_t on_overrun_set = UINT16_MAX, on_fault_set = UINT16_MAX;
  std::span<const PortSpec> ports;
  /// With a server the task is aperiodic, `period` and `deadline` are those of the server, and each event is one
  /// release.
  std::optional<ServerSpec> server;

  /// A ring of the doorbell of the task (signal wakeup) is one event. Context: any; wait-free.
  bool has_doorbell() const noexcept { return server.has_value() || has_events; }
};

}  // namespace chimera
