// SPDX-License-Identifier: Apache-2.0
// Finds the producer of a variable and reads its value, form and extent.
#include "chimera/manager/state/readings.h"

#include <algorithm>

namespace chimera::manager {
namespace {

std::vector<FieldDescriptor> fields_of(const Library& library, std::string_view component, std::uint32_t declared) {
  const LibraryEntry* entry = library.find(component);
  if (entry == nullptr || declared >= entry->descriptor.ports.size()) return {};
  return entry->descriptor.ports[declared].fields;
}

}  // namespace

Readings::Readings(const Peers& peers, const OwnSegment& own, const Configuration& configuration,
                   const Library& library, StateOf state_of)
    : peers_(peers), own_(own), state_of_(std::move(state_of)), variables_(peers.spec()) {
  for (std::size_t v = 0; v < variables_.all().size(); ++v) {
    forms_.push_back(form_of(v, configuration, library));
    by_name_.emplace(variables_.all()[v].name, v);
  }
}

Readings::Form Readings::form_of(std::size_t variable, const Configuration& configuration,
                                 const Library& library) const {
  const Variable& v = variables_.all()[variable];
  const ApplicationSpec& spec = peers_.spec();
  Form made;
  made.configured = &configuration.variable(VariableId(variable));
  CHIMERA_ASSERT(made.configured->name == v.name);  // the image and the configuration come from the same description
  const WrittenUnit& written = made.configured->written;
  made.form.unit = made.configured->unit;
  made.form.shown = written.text, made.form.factor = written.from.factor, made.form.offset = written.from.offset;
  made.form.is_scalar = made.configured->shape.empty();
  const bool is_operators = v.producers.empty();
  const PortOf& from = is_operators ? v.consumers[0] : v.producers[0];
  const PortSpec& port = *spec.port(is_operators ? CHIMERA_IN_VAR : CHIMERA_OUT_VAR, from);
  made.form.type = port.type;
  made.form.element_bytes = port.element_bytes;
  made.extents = v.is_given() ? spec.operators[v.operator_index].extent : port.extent;
  if (port.type == CHIMERA_STRUCT)
    made.form.fields = fields_of(library, spec.tasks[from.task.index].component, port.declared);
  return made;
}

std::optional<VariableId> Readings::find(std::string_view name) const noexcept {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? std::nullopt : std::optional(found->second);
}

const PortOf* Readings::source(const Variable& variable) const {
  const PortOf* last = variable.producer([this](TaskId task) { return state_of_(task) == State::kOn; });
  if (last != nullptr) return last;
  std::int64_t latest = INT64_MIN;
  for (const PortOf& port : variable.producers) {
    chimera_slot slot{};
    if (!read_output(port, slot, nullptr) || slot.sequence == 0 || slot.published_ns <= latest) continue;
    latest = slot.published_ns;
    last = &port;
  }
  return last;
}

TaskId Readings::producer(VariableId variable) const {
  const PortOf* from = source(variables_.all()[variable.index]);
  return from == nullptr ? TaskId() : from->task;
}

VariableReading Readings::read(VariableId variable) const { return read(variable, true); }

VariableReading Readings::read_header(VariableId variable) const { return read(variable, false); }

VariableReading Readings::read(VariableId variable, bool with_value) const {
  const Variable& v = variables_.all()[variable.index];
  VariableReading reading;
  reading.form = form(variable);
  if (is_operators(variable)) {
    const GroupReader reader = own_.operator_reader(v.operator_index);
    if (with_value) reading.value.resize(reader.payload_bytes());
    reading.is_valid = reader.try_read_part(reading.slot, 0, reading.value) && (reading.slot.valid & 1u) != 0;
  } else if (const PortOf* from = source(v);
             from != nullptr && read_output(*from, reading.slot, with_value ? &reading.value : nullptr)) {
    reading.producer = from->task;
    reading.is_valid = ((reading.slot.valid >> from->index) & 1u) != 0;
  }
  if (with_value) reading.value.resize(std::size_t{reading.form.count} * reading.form.element_bytes);
  return reading;
}

/// Copies only this output: the other outputs of the task may be large.
bool Readings::read_output(const PortOf& port, chimera_slot& slot, std::vector<std::byte>* value) const {
  const PeerSegment& segment = peers_.of(port.task);
  if (!segment.is_there()) return false;
  const PeerLayout& layout = peers_.layout(peers_.spec().tasks[port.task.index].rtpu);
  const GroupId group = layout.outputs(port.task, peers_.status(port.task).incarnation);
  const VariablePlace& place = layout.variables(group)[port.index];
  if (value == nullptr) return segment.group(group).try_read_part(slot, 0, {});
  value->resize(place.bytes);
  return segment.group(group).try_read_part(slot, place.offset, *value);
}

ValueForm Readings::form(VariableId variable) const {
  const Form& known = forms_[variable.index];
  ValueForm form = known.form;
  form.count = extent(known.extents[0]) * extent(known.extents[1]);
  return form;
}

std::uint32_t Readings::extent(const ExtentSpec& extent) const {
  if (!extent.constant.is_valid()) return extent.max;
  const auto value = constant(extent.constant);
  return value && *value >= 1 && *value <= extent.max ? static_cast<std::uint32_t>(*value) : extent.max;
}

std::optional<std::int64_t> Readings::constant(ConstantId id) const {
  const ConstantSpec& constant = peers_.spec().constants[id.index];
  const auto whole = [&constant](std::span<const std::byte> at) {
    ValueForm form;
    form.type = constant.type;
    form.element_bytes = constant.element_bytes;
    const std::vector<double> value = numbers(form, at.first(constant.element_bytes));
    return value.empty() ? std::nullopt : std::optional(static_cast<std::int64_t>(value[0]));
  };
  if (!constant.value.empty()) return whole(constant.value);
  const bool is_chosen = std::ranges::any_of(constant.producers, [this](const PortOf& port) { return is_on(port); });
  for (const PortOf& producer : constant.producers) {
    const PeerSegment& segment = peers_.of(producer.task);
    // If there are several producers, the one that is ON counts.
    if (!segment.is_there() || (is_chosen && !is_on(producer))) continue;
    const PeerLayout& layout = peers_.layout(peers_.spec().tasks[producer.task.index].rtpu);
    const GroupId group = layout.constants(producer.task);
    const VariablePlace& place = layout.variables(group)[producer.index];
    std::vector<std::byte> payload(layout.place(group).payload_bytes);
    chimera_slot slot;
    if (place.bytes >= constant.element_bytes && segment.group(group).try_read(slot, payload.data()) &&
        slot.sequence > 0)
      return whole(std::span(payload).subspan(place.offset, place.bytes));
  }
  return std::nullopt;
}

}  // namespace chimera::manager
