// SPDX-License-Identifier: Apache-2.0
// Allocates the memory of a task and connects each port to its place in it.
#include "chimera/runtime/state/task_memory.h"

#include <algorithm>
#include <cstring>

#include "chimera/base/mechanisms.h"
#include "chimera/base/message.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/table/never_written.h"

namespace chimera {
namespace {

bool is_variable(std::uint32_t kind) noexcept { return kind == CHIMERA_IN_VAR || kind == CHIMERA_OUT_VAR; }

bool is_constant(std::uint32_t kind) noexcept { return kind == CHIMERA_IN_CONST || kind == CHIMERA_OUT_CONST; }

Error misfit(const TaskSpec& spec, const char* what, std::string_view port = {}) {
  if constexpr (mechanisms::kVerified) return Error{};
  Message text;
  text << "component " << spec.component << ": " << what << (port.empty() ? "" : " ") << port;
  return (text << "; was it built from another source than its descriptor?").error(ErrorCode::kBadInput, spec.name);
}

void never_written(std::byte* at, std::uint32_t type, std::uint32_t bytes) noexcept {
  const NeverWritten kind = type == CHIMERA_FLOAT64   ? NeverWritten::kFloat64
                            : type == CHIMERA_FLOAT32 ? NeverWritten::kFloat32
                                                      : NeverWritten::kZero;
  fill_never_written({at, bytes}, kind);
}

void never_written(std::byte* at, const DeclaredPort& declared, const PortSpec& spec) noexcept {
  if (spec.type != CHIMERA_STRUCT) return never_written(at, spec.type, spec.max_bytes());
  std::memset(at, 0, spec.max_bytes());
  for (std::uint32_t e = 0; e < spec.max_count(); ++e)
    for (std::uint32_t f = 0; f < declared.n_fields(); ++f) {
      const FieldForm field = declared.field(f);
      never_written(at + e * spec.element_bytes + field.offset, field.type, field.size * field.count);
    }
}

Result<void> check_port(const TaskSpec& spec, const chimera_component& component, const DeclaredPort& declared,
                        const PortSpec& port) {
  const std::uint32_t kind = declared.kind();
  const std::string_view name = name_of(component, port);
  if (kind != port.kind) return misfit(spec, "another kind of port", name);
  if (port.instance >= declared.max_instances()) return misfit(spec, "too many instances of port", name);
  if (declared.type() != CHIMERA_ANY && kind != CHIMERA_RESOURCE && declared.element_size() != port.element_bytes)
    return misfit(spec, "another element size at port", name);
  if (!is_variable(kind) && !is_constant(kind) && kind != CHIMERA_RESOURCE)
    return misfit(spec, "streams cannot be bound yet, port", name);
  return {};
}

// Constructs the component in `state` and destroys it, if it does not declare its ports.
Result<DeclaredPorts> find_ports(const TaskSpec& spec, const chimera_component& component, std::span<std::byte> state,
                                 SetupMemory& memory) {
  std::size_t n = 0;
  for (const PortSpec& port : spec.ports) n = std::max<std::size_t>(n, port.declared + 1);
  if (component.ports != nullptr || n == 0) return DeclaredPorts(component);
  const std::span<WiredPort> wired = memory.take<WiredPort>(n);
  const Wiring wiring(wired, state);
  chimera_fault fault{};
  if (component.construct(state.data(), &fault) != CHIMERA_OK)
    return Error{ErrorCode::kRefused, {fault.text}, {spec.name}};
  component.destroy(state.data());
  if (!wiring.is_inside()) return misfit(spec, "a port is no member of it");
  return DeclaredPorts(wired.first(std::min(n, wiring.size())));
}

// `name`: of the port.
bool is_in_range(const ExtentSpec& extent, std::string_view name, const ConstantStore& store, FaultWords& why) {
  if constexpr (!mechanisms::kConstants) return true;  // the description gives all constants, which are verified
  const std::int64_t n = !extent.constant.is_valid() ? extent.max : store.integer(extent.constant, extent.max);
  if (n >= 1 && n <= extent.max) return true;
  const std::string_view constant = extent.constant.is_valid() ? store[extent.constant].spec->name : "";
  Message text("extent ");
  text << constant << " = " << n << " of port " << name;
  why.assign((text << " is outside 1 to " << extent.max).view());
  return false;
}

}  // namespace

Result<TaskMemory> TaskMemory::create(const TaskSpec& spec, const chimera_component& component, SetupMemory& memory) {
  TaskMemory made;
  made.spec_ = &spec;
  made.component_ = &component;
  made.memory_ = &memory;
  made.state_ = memory.take_bytes(component.state_size, component.state_align);
  const auto found = find_ports(spec, component, made.state_, memory);
  if (!found) return found.error();
  made.ports_ = *found;
  if (auto planned = made.plan(); !planned) return planned.error();
  made.take_lists(memory);
  made.constant_memory_ = memory.take_bytes(made.constant_bytes_, kCacheLine);
  return made;
}

void TaskMemory::place(std::span<std::byte> first, std::span<std::byte> second) {
  groups_[0] = first;
  groups_[1] = second;
  make_fill();
  for (std::span<std::byte> group : groups_) {
    GroupWriter writer(group, payload_bytes_);
    std::copy(fill_.begin(), fill_.end(), writer.staging());
    writer.publish_initial(Nanoseconds{}, initial_valid_);
  }
}

Result<void> TaskMemory::plan() {
  std::size_t outputs = 0;
  for (const PortSpec& port : spec_->ports) {
    if (port.declared >= ports_.size()) return misfit(*spec_, "it declares fewer ports");
    if (auto checked = check_port(*spec_, *component_, ports_[port.declared], port); !checked) return checked;
    if (port.kind != CHIMERA_OUT_VAR) continue;
    if (outputs == 64) return misfit(*spec_, "more than 64 out-vars, at port", name_of(*component_, port));
    if (!port.value.empty()) initial_valid_ |= std::uint64_t{1} << outputs;
    ++outputs;
  }
  return {};
}

void TaskMemory::take_lists(SetupMemory& memory) {
  std::size_t inputs = 0, outputs = 0, constants = 0, resources = 0;
  for (const PortSpec& port : spec_->ports)
    ++(port.kind == CHIMERA_IN_VAR ? inputs : port.kind == CHIMERA_OUT_VAR ? outputs
                                          : is_constant(port.kind)         ? constants
                                                                           : resources);
  inputs_ = memory.take<Input>(inputs);
  input_specs_ = memory.take<const PortSpec*>(inputs);
  outputs_ = memory.take<Output>(outputs);
  inherited_ = memory.take<chimera_inherited>(outputs);
  constants_ = memory.take<ConstantPort>(constants);
  resources_ = memory.take<ResourcePort>(resources);
  inputs = outputs = constants = resources = 0;
  for (const PortSpec& port : spec_->ports) {
    if (port.kind == CHIMERA_IN_VAR) {
      input_specs_[inputs++] = &port;
    } else if (port.kind == CHIMERA_OUT_VAR) {
      outputs_[outputs++] = {nullptr, &port, payload_bytes_, port.max_bytes()};  // as TableLayout places them
      payload_bytes_ += round_to_value(port.max_bytes());
    } else if (is_constant(port.kind)) {
      constants_[constants++] = {nullptr, &port, nullptr};
      constant_bytes_ += round_to_value(port.max_bytes());
    } else {
      const std::span<std::byte> text = memory.take_bytes(port.value.size() + 1, 1);  // a zero behind it
      std::copy(port.value.begin(), port.value.end(), text.begin());
      resources_[resources++] = {&port, reinterpret_cast<const char*>(text.data())};
    }
  }
}

chimera_port* TaskMemory::live(const PortSpec& port) const noexcept {
  return reinterpret_cast<chimera_port*>(state_.data() + ports_[port.declared].live_offset()) + port.instance;
}

const PortSpec* TaskMemory::spec_of(const chimera_port* port) const noexcept {
  for (const PortSpec& spec : spec_->ports)
    if (live(spec) == port) return &spec;
  return nullptr;
}

void TaskMemory::make_fill() {
  fill_ = memory_->take_bytes(payload_bytes_, kCacheLine);
  for (const Output& output : outputs_) {
    const PortSpec& spec = *output.spec;
    std::byte* to = fill_.data() + output.offset;
    if (spec.value.empty()) never_written(to, ports_[spec.declared], spec);
    else std::memcpy(to, spec.value.data(), std::min<std::size_t>(spec.value.size(), output.bytes));
  }
}

bool TaskMemory::is_unwritten(const Task& task, std::size_t i) const noexcept {
  const Output& output = outputs_[i];
  return std::memcmp(fill_.data() + output.offset, task.group.staging() + output.offset, output.bytes) == 0;
}

GroupReader TaskMemory::reader() const noexcept {
  return GroupReader(groups_[incarnation_ % 2].data(), payload_bytes_);
}

Result<void> TaskMemory::construct(Task& task, Nanoseconds now) {
  std::fill(state_.begin(), state_.end(), std::byte{});
  task.faults.last = {};
  if (component_->construct(state_.data(), &task.faults.last) != CHIMERA_OK)
    return Error{ErrorCode::kRefused, {task.faults.last.text}, {spec_->name}};
  is_constructed_ = true;
  ++incarnation_;
  task.instance = state_.data();
  task.group = GroupWriter(groups_[incarnation_ % 2], payload_bytes_);
  std::copy(fill_.begin(), fill_.end(), task.group.staging());
  task.group.publish_initial(now, initial_valid_);
  task.valid = initial_valid_;
  wire(task);
  return {};
}

void TaskMemory::wire(Task& task) noexcept {
  for (const PortSpec& port : spec_->ports) {
    const DeclaredPort declared = ports_[port.declared];
    chimera_port& to = *live(port);
    to = {};
    to.now_ns = &task.call.now_ns;
    to.extent[0] = port.extent[0].max;
    to.extent[1] = port.extent[1].max;
    to.count = port.max_count();
    to.type = port.type;
    to.element_size = port.element_bytes;
    if (declared.is_repeated()) {
      auto* instances = reinterpret_cast<std::uint32_t*>(state_.data() + declared.instances_offset());
      *instances = std::max(*instances, port.instance + 1);
    }
  }
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i].port = live(*input_specs_[i]);
  task.has_safety = false;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    outputs_[i].port = live(*outputs_[i].spec);
    outputs_[i].port->bit = static_cast<std::uint32_t>(i);
    task.has_safety = task.has_safety || outputs_[i].spec->safety;
  }
  std::byte* next = constant_memory_.data();
  for (ConstantPort& constant : constants_) {
    constant.port = live(*constant.spec);
    constant.local = next;
    const bool can_be_given = constant.spec->kind == CHIMERA_OUT_CONST || constant.spec->constant.is_valid() ||
                              !constant.spec->value.empty();
    constant.port->value = can_be_given ? next : nullptr;
    next += round_to_value(constant.spec->max_bytes());
    if (!constant.spec->value.empty())
      std::memcpy(constant.local, constant.spec->value.data(), constant.spec->value.size());
  }
  for (const ResourcePort& resource : resources_) live(*resource.spec)->value = const_cast<char*>(resource.text);
  task.ports = ports_;
  task.inputs = inputs_;
  task.outputs = outputs_;
  task.inherited = inherited_.data();
  task.all_outputs = outputs_.size() >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << outputs_.size()) - 1;
  task.cycle = component_->methods[CHIMERA_CYCLE];
  task.asks_sync = spec_->aperiodic;
  stage_outputs(task);
}

void TaskMemory::destroy(Task& task) noexcept {
  if (is_constructed_) component_->destroy(state_.data());
  is_constructed_ = false;
  task.instance = nullptr;
}

void TaskMemory::abandon(Task& task) {
  memory_->keep_for_ever();
  state_ = memory_->take_bytes(component_->state_size, component_->state_align);
  is_constructed_ = false;
  task.instance = nullptr;
}

bool TaskMemory::read_constants(const ConstantStore& store, FaultWords& why) noexcept {
  for (ConstantPort& constant : constants_) {
    if (constant.spec->kind != CHIMERA_IN_CONST || !constant.spec->constant.is_valid()) continue;
    const Constant& found = store[constant.spec->constant];
    if (!found.is_known) continue;
    std::memcpy(constant.local, found.value.data(),
                std::min<std::size_t>(found.value.size(), constant.spec->max_bytes()));
  }
  return would_take(store, why) && fix_extents(store, why);
}

bool TaskMemory::would_take(const ConstantStore& store, FaultWords& why) const noexcept {
  if constexpr (!mechanisms::kConstants) return true;
  for (const ConstantPort& constant : constants_) {
    if (constant.spec->kind != CHIMERA_IN_CONST || !constant.spec->constant.is_valid()) continue;
    const Constant& found = store[constant.spec->constant];
    if (found.is_known || !constant.spec->value.empty()) continue;
    const std::string_view name = found.spec->name;
    why.assign((Message("constant ") << name << " has no value: its producer was not initialised").view());
    return false;
  }
  for (const PortSpec& port : spec_->ports)
    for (const ExtentSpec& extent : port.extent)
      if (!is_in_range(extent, name_of(*component_, port), store, why)) return false;
  return true;
}

bool TaskMemory::uses_changed(const ConstantStore& store) const noexcept {
  for (const ConstantPort& constant : constants_) {
    if (constant.spec->kind != CHIMERA_IN_CONST || !constant.spec->constant.is_valid()) continue;
    const Constant& found = store[constant.spec->constant];
    if (!found.is_known) continue;
    const std::size_t bytes = std::min<std::size_t>(found.value.size(), constant.spec->max_bytes());
    if (std::memcmp(constant.local, found.value.data(), bytes) != 0) return true;
  }
  for (const PortSpec& port : spec_->ports)
    for (std::size_t d = 0; d < CHIMERA_MAX_EXTENTS; ++d) {
      const ExtentSpec& extent = port.extent[d];
      if (!extent.constant.is_valid()) continue;
      if (store.integer(extent.constant, extent.max) != live(port)->extent[d]) return true;
    }
  return false;
}

int TaskMemory::write_constants(ConstantStore& store, TaskId task) noexcept {
  int changed = 0;
  for (const ConstantPort& constant : constants_) {
    if (constant.spec->kind != CHIMERA_OUT_CONST) continue;
    changed += store.set_by(task, constant.spec->constant, {constant.local, constant.spec->max_bytes()}) ? 1 : 0;
  }
  return changed;
}

bool TaskMemory::fix_extents(const ConstantStore& store, FaultWords& why) noexcept {
  for (const PortSpec& port : spec_->ports) {
    chimera_port& to = *live(port);
    to.count = 1;
    for (std::size_t d = 0; d < CHIMERA_MAX_EXTENTS; ++d) {
      const ExtentSpec& extent = port.extent[d];
      if (!is_in_range(extent, name_of(*component_, port), store, why)) return false;
      to.extent[d] = static_cast<std::uint32_t>(
          extent.constant.is_valid() ? store.integer(extent.constant, extent.max) : extent.max);
      to.count *= to.extent[d];
    }
  }
  return true;
}

}  // namespace chimera
