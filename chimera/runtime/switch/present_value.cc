// SPDX-License-Identifier: Apache-2.0
// Finds the producer of the variable, then the element in its latest publication.
#include "chimera/runtime/switch/present_value.h"

#include <limits>

#include "chimera/task/number_at.h"

namespace chimera {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

// How many elements of which kind the variable has there.
struct Elements {
  std::uint32_t type = CHIMERA_FLOAT64, bytes = 0, count = 0;
};

// Of another context the elements are known at their maxima; those that its task does not have were never written.
Elements elements_of(TaskSet& set, const Source& source) noexcept {
  if (!source.task.is_valid()) {
    const GivenSpec& given = set.spec().operators[source.operator_index];
    return {given.type, given.element_bytes, given.extent[0].max * given.extent[1].max};
  }
  const PortSpec* port = set.spec().port(CHIMERA_OUT_VAR, {source.task, source.bit});
  if (port == nullptr) return {};
  const chimera_port* here = set.is_mine(source.task) ? set.memory(source.task).output_port(source.bit) : nullptr;
  return {port->type, port->element_bytes, here == nullptr ? port->max_count() : here->count};
}

bool is_produced(TaskSet& set, const Source& source) noexcept {
  if (!source.task.is_valid()) return true;
  const bool is_mine = set.is_mine(source.task);
  if (!is_mine && set.others() == nullptr) return false;
  return (is_mine ? set.tasks()[source.task.index].state : set.others()->state(source.task)) == State::kOn;
}

}  // namespace

double present_value(TaskSet& set, const SafeCondition& condition) noexcept {
  const Source& source = set.sources().source(condition.variable);
  if (!is_produced(set, source)) return kNoValue;
  const chimera_slot* slot = set.sources().latest(condition.variable);
  const Elements elements = elements_of(set, source);
  if (slot == nullptr || ((slot->valid >> source.bit) & 1u) == 0 || condition.element >= elements.count)
    return kNoValue;
  const auto* values = reinterpret_cast<const std::byte*>(slot + 1) + source.offset;
  return number_at(elements.type, values + std::size_t{condition.element} * elements.bytes);
}

}  // namespace chimera
