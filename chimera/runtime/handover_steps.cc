// SPDX-License-Identifier: Apache-2.0
// Keeps the last values of variables that get another producer, and measures the step to the next.
#include "chimera/runtime/handover_steps.h"

#include <algorithm>
#include <cstring>

namespace chimera {
namespace {

std::uint32_t bytes_of(const ApplicationSpec& spec, const PortOf& output) noexcept {
  std::uint32_t at = 0;
  for (const PortSpec& port : spec.tasks[output.task.index].ports)
    if (port.kind == CHIMERA_OUT_VAR && at++ == output.index) return port.max_bytes();
  return 0;
}

template <class T>
double read_as(const std::byte* from) noexcept {
  T value;
  std::memcpy(&value, from, sizeof value);
  return static_cast<double>(value);
}

bool is_number(std::uint32_t type) noexcept { return type <= CHIMERA_FLOAT64; }

double number_at(std::uint32_t type, const std::byte* from) noexcept {
  switch (type) {
    case CHIMERA_BOOL: return read_as<std::uint8_t>(from);
    case CHIMERA_INT32: return read_as<std::int32_t>(from);
    case CHIMERA_INT64: return read_as<std::int64_t>(from);
    case CHIMERA_FLOAT32: return read_as<float>(from);
    default: return read_as<double>(from);
  }
}

double distance(double a, double b) noexcept { return a < b ? b - a : a - b; }

// Three values of one element: before, after, and its limit; null if it has none.
struct Place3 {
  const std::byte *before, *after, *limit;

  Place3 behind(std::size_t bytes) const noexcept {
    return {before + bytes, after + bytes, limit == nullptr ? nullptr : limit + bytes};
  }
};

void compare(ValueStep& found, std::uint32_t type, const Place3& at) noexcept {
  if (!is_number(type)) return;
  const double size = distance(number_at(type, at.before), number_at(type, at.after));
  const double limit = at.limit == nullptr ? 0 : number_at(type, at.limit);
  const bool is_beyond = limit > 0 && !(size <= limit);
  const double share = limit > 0 ? size / limit : size;
  const double before = found.limit > 0 ? found.size / found.limit : found.size;
  // Whatever is beyond its limit goes before what is not; NaN is beyond every limit.
  const bool is_farther = is_beyond != found.is_beyond ? is_beyond : !(share <= before);
  if (!found.is_known || is_farther) {
    found.size = size;
    found.limit = limit;
  }
  found.is_known = true;
  found.is_beyond = found.is_beyond || is_beyond;
}

}  // namespace

ValueStep step_between(const PortSpec& port, const chimera_port_decl& declared, std::uint32_t count,
                       const std::byte* before, const std::byte* after) noexcept {
  ValueStep found;
  const Place3 begin{before, after, port.max_step.empty() ? nullptr : port.max_step.data()};
  for (std::uint32_t e = 0; e < count; ++e) {
    const Place3 element = begin.behind(std::size_t{e} * port.element_bytes);
    if (port.type != CHIMERA_STRUCT) {
      compare(found, port.type, element);
      continue;
    }
    for (std::uint32_t f = 0; f < declared.n_fields; ++f) {
      const chimera_field& field = declared.fields[f];
      for (std::uint32_t i = 0; i < field.count; ++i)
        compare(found, field.type, element.behind(field.offset + std::size_t{i} * field.size));
    }
  }
  return found;
}

void HandoverSteps::prepare() {
  const ApplicationSpec& spec = set_.spec();
  SetupMemory& memory = set_.setup_memory();
  has_last_ = memory.take<bool>(spec.variables.size());
  last_ = memory.take<std::span<std::byte>>(spec.variables.size());
  watched_ = memory.take<std::span<std::byte>>(spec.variables.size());
  watched_sequence_ = memory.take<std::uint64_t>(spec.variables.size());
  for (std::size_t v = 0; v < spec.variables.size(); ++v) {
    std::uint32_t most = 0;
    for (const PortOf& producer : spec.variables[v].producers) most = std::max(most, bytes_of(spec, producer));
    last_[v] = memory.take_bytes(most, alignof(double));
    watched_[v] = memory.take_bytes(most, alignof(double));
  }
}

void HandoverSteps::keep_last(std::span<const VariablePart> variables) noexcept {
  for (const VariablePart& part : variables) {
    const Source& source = set_.sources().source(part.handover.variable);
    has_last_[part.handover.variable.index] = false;
    if (!part.handover.from.task.is_valid()) continue;
    keep(part.handover, set_.sources().latest(part.handover.variable), source.offset, source.bit);
  }
}

void HandoverSteps::keep_last_of(const Handover& handover) noexcept {
  const Task& producer = set_.tasks()[handover.from.task.index];
  const std::uint32_t offset = set_.memory(producer.id).output_offset(handover.from.index);
  keep(handover, producer.group.published(), offset, handover.from.index);
}

void HandoverSteps::keep(const Handover& handover, const chimera_slot* slot, std::uint32_t offset,
                         std::uint32_t bit) noexcept {
  const std::span<std::byte> last = last_[handover.variable.index];
  has_last_[handover.variable.index] = slot != nullptr && ((slot->valid >> bit) & 1u) != 0;
  if (!has_last_[handover.variable.index]) return;
  std::memcpy(last.data(), reinterpret_cast<const std::byte*>(slot + 1) + offset, bytes_of(set_.spec(), handover.from));
}

void HandoverSteps::begin_watch() noexcept {
  std::fill(watched_sequence_.begin(), watched_sequence_.end(), std::uint64_t{0});
}

void HandoverSteps::keep_watched(const Handover& handover) noexcept {
  const std::size_t v = handover.variable.index;
  if (watched_sequence_[v] == 0) return;
  std::memcpy(last_[v].data(), watched_[v].data(), bytes_of(set_.spec(), handover.from));
  has_last_[v] = true;
}

// The step of `off` is none of its cycles.
void HandoverSteps::watch(std::span<VariablePart> variables) noexcept {
  for (VariablePart& part : variables) {
    const Handover& handover = part.handover;
    const TaskId from = handover.from.task;
    if (!set_.is_mine(handover.to.task) || !from.is_valid()) continue;
    const bool is_on = (set_.is_mine(from) ? set_.tasks()[from.index].state : set_.others()->state(from)) == State::kOn;
    const Source& source = set_.sources().source(handover.variable);
    const chimera_slot* const slot = set_.sources().latest(handover.variable);
    std::uint64_t& seen = watched_sequence_[handover.variable.index];
    if (!is_on || slot == nullptr || ((slot->valid >> source.bit) & 1u) == 0 || slot->sequence == seen) continue;
    const std::byte* const value = reinterpret_cast<const std::byte*>(slot + 1) + source.offset;
    const std::span<std::byte> before = watched_[handover.variable.index];
    const ValueStep step = this->step(handover, before.data(), value);
    if (seen != 0 && slot->sequence == seen + 1 && step.is_known && !(step.size <= part.usual.size)) part.usual = step;
    if (seen != 0 && slot->sequence == seen + 1 && step.is_known) part.usual.is_known = true;
    seen = slot->sequence;
    std::memcpy(before.data(), value, bytes_of(set_.spec(), handover.from));
  }
}

ValueStep HandoverSteps::step(const Handover& handover, const std::byte* from, const std::byte* to) const noexcept {
  const Task& producer = set_.tasks()[handover.to.task.index];
  const TaskMemory& memory = set_.memory(producer.id);
  const chimera_port* const port = memory.output_port(handover.to.index);
  if (port == nullptr) return {};  // it is not created yet
  const PortSpec& spec = *memory.output_spec(handover.to.index);
  return step_between(spec, producer.component->ports[spec.declared], port->count, from, to);
}

ValueStep HandoverSteps::step_to(const Handover& handover) noexcept {
  const Task& producer = set_.tasks()[handover.to.task.index];
  const chimera_slot* slot = producer.group.published();
  if (!has_last_[handover.variable.index] || ((slot->valid >> handover.to.index) & 1u) == 0) return {};
  const std::uint32_t offset = set_.memory(producer.id).output_offset(handover.to.index);
  return step(handover, last_[handover.variable.index].data(), reinterpret_cast<const std::byte*>(slot + 1) + offset);
}

}  // namespace chimera
