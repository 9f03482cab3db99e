// SPDX-License-Identifier: Apache-2.0
// Adds up sizes of the tables and records of an image, by the sizes of a 32-bit machine.
#include "chimera/bake/memory.h"

#include <algorithm>

#include "chimera/runtime/executive/baked_sizes.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/link/frame.h"
#include "chimera/runtime/link/link_layout.h"

namespace chimera::bake {
namespace {

constexpr std::size_t kPayloads = 2;  // of a group: the published values and those under way
constexpr std::size_t kPayloadsOfTask = 2 * kPayloads + 1;  // of its two groups, and the values of a new incarnation

std::size_t rounded_up(std::size_t bytes, std::size_t to) { return (bytes + to - 1) / to * to; }

/// Numbers of type float64 in the port.
std::size_t doubles_of(const PortSpec& port) { return port.type == CHIMERA_FLOAT64 ? port.max_count() : 0; }

void add_port(TaskMemoryNeed& need, std::size_t& group_bytes, const PortSpec& port) {
  need.flash_bytes += baked::kPortSpecBytes + rounded_up(port.value.size(), 8) + port.max_step.size() +
                      port.unit.size() + 1;
  need.ram_bytes += baked::kLivePortBytes + baked::kWiredPortBytes;
  if (port.kind == CHIMERA_IN_VAR) need.ram_bytes += baked::kInputBytes;
  if (port.kind == CHIMERA_OUT_VAR) {
    need.ram_bytes += baked::kOutputBytes;
    group_bytes += rounded_up(port.max_bytes(), 8);
  }
  if (port.kind == CHIMERA_IN_CONST || port.kind == CHIMERA_OUT_CONST)
    need.ram_bytes += baked::kConstantPortBytes + rounded_up(port.max_bytes(), 8);
  if (port.kind == CHIMERA_RESOURCE) need.ram_bytes += baked::kResourcePortBytes + rounded_up(port.value.size() + 1, 4);
  if (port.kind == CHIMERA_IN_VAR) need.float64_in += doubles_of(port);
  if (port.kind == CHIMERA_OUT_VAR) need.float64_out += doubles_of(port);
}

TaskMemoryNeed need_of(const TaskSpec& task, std::size_t record_bytes) {
  TaskMemoryNeed need;
  need.flash_bytes = baked::kTaskSpecBytes + task.name.size() + task.component.size() + 2;
  need.ram_bytes = record_bytes + 2 * baked::kGroupHeadBytes;
  std::size_t group_bytes = 0;
  for (const PortSpec& port : task.ports) add_port(need, group_bytes, port);
  need.ram_bytes += kPayloadsOfTask * group_bytes;
  return need;
}

/// Plans in flash, and what the planner, the record and the receipt of a switch keep for each task and variable.
void add_switches(const ApplicationSpec& spec, MemoryNeed& need) {
  if (spec.plans == nullptr) return;
  for (const SwitchPlan& plan : std::span(spec.plans, spec.sets.size() * spec.sets.size()))
    need.shared_flash_bytes +=
        baked::kSwitchPlanBytes + baked::kHandoverBytes * plan.handovers.size() +
        baked::kTaskIdBytes * (plan.arriving.size() + plan.leaving.size() + plan.staying.size());
  need.shared_ram_bytes += kSwitchBytes + kSwitchTaskBytes * spec.tasks.size();
  for (const Variable& variable : spec.variables) {
    std::size_t most = 0;
    for (const PortOf& producer : variable.producers)
      if (const PortSpec* const port = spec.port(CHIMERA_OUT_VAR, producer))
        most = std::max<std::size_t>(most, port->max_bytes());
    need.shared_ram_bytes += kSwitchVariableBytes + 2 * rounded_up(most, 8);
  }
}

}  // namespace

std::size_t MemoryNeed::flash_bytes() const noexcept {
  std::size_t bytes = shared_flash_bytes;
  for (const TaskMemoryNeed& task : tasks) bytes += task.flash_bytes;
  return bytes;
}

std::size_t MemoryNeed::ram_bytes() const noexcept {
  std::size_t bytes = shared_ram_bytes + stack_bytes;
  for (const TaskMemoryNeed& task : tasks) bytes += task.ram_bytes;
  return bytes;
}

std::size_t link_ram(const ApplicationSpec& part) {
  HeapMemory memory;
  board_link::LinkLayout layout;
  layout.plan(part, RtpuId(0u), memory);
  const std::size_t frame = layout.most_from_board_bytes();
  return sizeof(board_link::FrameDecoder) + layout.to_board_bytes() + frame + board_link::line_bytes(frame) +
         sizeof(board_link::Import) * layout.imports().size() + sizeof(board_link::Export) * layout.exports().size();
}

MemoryNeed memory_need(const ApplicationSpec& spec, std::size_t n_acts, const Target& target) {
  MemoryNeed need;
  need.record_bytes = baked::kTaskRecordBytes + (spec.sets.size() > 1 ? baked::kSwitchRecordBytes : 0);
  for (const TaskSpec& task : spec.tasks) need.tasks.push_back(need_of(task, need.record_bytes));
  std::size_t& flash = need.shared_flash_bytes;
  flash = baked::kApplicationSpecBytes + n_acts * baked::kScriptActBytes;
  flash += baked::kTaskIdBytes * (spec.init_order.size() + spec.start.size() + spec.on_order.size() +
                                  spec.end_order.size());
  add_switches(spec, need);
  for (const NamedSet& set : spec.sets)
    flash += baked::kNamedSetBytes + baked::kTaskIdBytes * set.order.size() + set.name.size() + 1;
  for (const Variable& variable : spec.variables)
    flash += baked::kVariableBytes + baked::kPortOfBytes * (variable.producers.size() + variable.consumers.size()) +
             variable.name.size() + 1;
  for (const ConstantSpec& constant : spec.constants)
    flash += baked::kConstantSpecBytes + baked::kPortOfBytes * constant.producers.size() + constant.value.size() +
             constant.name.size() + 1;
  for (const GivenSpec& given : spec.operators) {
    flash += baked::kGivenSpecBytes + given.value.size();
    need.shared_ram_bytes += baked::kGroupHeadBytes + kPayloads * rounded_up(given.value.size(), 8);
  }
  need.stack_bytes = std::size_t{target.stack_bytes} + target.handler_stack_bytes;
  return need;
}

}  // namespace chimera::bake
