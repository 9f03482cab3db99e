// SPDX-License-Identifier: Apache-2.0
// The memory behind one task: component state, constants, resources, groups, and the wiring of every port.
#pragma once

#include <span>

#include "chimera/base/result.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/state/constant_store.h"
#include "chimera/table/layout.h"
#include "chimera/task/declared_port.h"
#include "chimera/task/task.h"

namespace chimera {

/// A constant port of a task: `local` is what the component sees.
struct ConstantPort {
  chimera_port* port = nullptr;
  const PortSpec* spec = nullptr;
  std::byte* local = nullptr;
};

/// Manages the data that a Task points at, all of it taken from given memory. Copyable before construct(). Context:
/// setup and cycle boundary.
class TaskMemory {
 public:
  /// Plans the memory for `spec`. Refuses a specification that does not fit the ports of the component (a descriptor of
  /// another build): names task and port. If the component does not declare its ports, constructs and destroys it once,
  /// to find them.
  static Result<TaskMemory> create(const TaskSpec& spec, const chimera_component& component, SetupMemory& memory);

  /// Gives the task its places in the table: two groups, used in turn by its incarnations, with the never-written
  /// fill and initial values published in both. Requires: group_bytes() of reader().payload_bytes() each.
  void place(std::span<std::byte> first, std::span<std::byte> second);

  /// Constructs the component anew in zeroed state and wires its ports: constants and resources to local memory,
  /// outputs to a group that no consumer of the previous incarnation is bound to.
  /// Leaves task.group published with the initial values (never-written fill where there are none).
  Result<void> construct(Task& task, Nanoseconds now);
  void destroy(Task& task) noexcept;
  /// As destroy, but never frees the state: a call of the background that hangs may still use it.
  void abandon(Task& task);

  /// Copies constants in; false with `why` when one has no value. Sets extents that constants fix.
  bool read_constants(const ConstantStore& store, FaultWords& why) noexcept;
  /// Copies out-consts to the store as those of the task; answers the number of constants that changed.
  int write_constants(ConstantStore& store, TaskId task) noexcept;
  /// Fixes the extents of all ports from known constants; false with `why` when one is out of range.
  bool fix_extents(const ConstantStore& store, FaultWords& why) noexcept;
  /// True if the task could be initialised with these constants. As read_constants(), but changes nothing.
  bool would_take(const ConstantStore& store, FaultWords& why) const noexcept;

  /// The group that consumers may be bound to before the task was ever spawned: the never-written fill.
  GroupReader reader() const noexcept;
  /// Number of constructions: outputs go to group incarnation modulo 2.
  std::uint32_t incarnation() const noexcept { return incarnation_; }
  /// False for the memory of a task of another context.
  bool is_planned() const noexcept { return component_ != nullptr; }
  std::span<Input> inputs() noexcept { return inputs_; }
  std::span<const ConstantPort> constants() const noexcept { return constants_; }
  std::uint64_t initial_valid() const noexcept { return initial_valid_; }
  /// Place of output `i` in the payload, its specification, and its live half (nullptr: not constructed).
  std::uint32_t output_offset(std::size_t i) const noexcept { return outputs_[i].offset; }
  const PortSpec& input_spec(std::size_t i) const noexcept { return *input_specs_[i]; }
  const PortSpec* output_spec(std::size_t i) const noexcept { return outputs_[i].spec; }
  const chimera_port* output_port(std::size_t i) const noexcept { return is_constructed_ ? outputs_[i].port : nullptr; }
  /// The specification of the port with this live half; nullptr: there is none. Context: any; wait-free; O(ports).
  const PortSpec* spec_of(const chimera_port* port) const noexcept;
  /// True if a constant that the component was initialised with, or that is an extent of a port, has another value now.
  /// Requires: the component was constructed.
  bool uses_changed(const ConstantStore& store) const noexcept;
  /// True if the staged value of output `i` is still the never-written fill.
  bool is_unwritten(const Task& task, std::size_t i) const noexcept;

 private:
  Result<void> plan();
  void take_lists(SetupMemory& memory);
  void wire(Task& task) noexcept;
  void make_fill();
  chimera_port* live(const PortSpec& port) const noexcept;

  /// A resource port: `text` is what the component sees.
  struct ResourcePort {
    const PortSpec* spec = nullptr;
    const char* text = nullptr;
  };

  const TaskSpec* spec_ = nullptr;
  const chimera_component* component_ = nullptr;
  SetupMemory* memory_ = nullptr;
  DeclaredPorts ports_;
  std::span<std::byte> state_;
  std::span<std::byte> constant_memory_;
  std::span<std::byte> groups_[2];
  std::uint32_t payload_bytes_ = 0;
  std::uint32_t constant_bytes_ = 0;
  std::uint32_t incarnation_ = 0;
  std::uint64_t initial_valid_ = 0;
  bool is_constructed_ = false;
  std::span<Input> inputs_;
  std::span<const PortSpec*> input_specs_;  ///< of inputs_, in the same order
  std::span<Output> outputs_;
  std::span<chimera_inherited> inherited_;  ///< by output
  std::span<std::byte> fill_;  ///< payload of a group at spawn: initial values, else the never-written fill
  std::span<ConstantPort> constants_;
  std::span<ResourcePort> resources_;
};

}  // namespace chimera
