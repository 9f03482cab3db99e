// SPDX-License-Identifier: Apache-2.0
// Checks each element of a safety port for being finite and within its range.
#include "chimera/runtime/job/safety.h"

#include <algorithm>
#include <cstring>

#include "chimera/base/math.h"
#include "chimera/base/message.h"
#include "chimera/base/number_text.h"

namespace chimera {
namespace {

double element(const chimera_port& port, std::uint32_t type, std::uint32_t i) noexcept {
  if (type == CHIMERA_FLOAT64) return static_cast<const double*>(port.value)[i];
  if (type == CHIMERA_FLOAT32) return static_cast<double>(static_cast<const float*>(port.value)[i]);
  if (type == CHIMERA_INT32) return static_cast<double>(static_cast<const std::int32_t*>(port.value)[i]);
  return static_cast<double>(static_cast<const std::int64_t*>(port.value)[i]);
}

// Cycle path: this text is made only when a value is refused, which ends the cycle in a fault anyway.
bool refuse(const Task& task, const Output& output, std::uint32_t i, double value, char* text) noexcept {
  Message said("safety port ");
  said << name_of(*task.component, *output.spec) << ": element " << i << " is ";
  if (math::is_nan(value)) said << "NaN";
  else if (!math::is_finite(value)) said << "infinite";
  else
    said << number_text(value).view() << ", outside " << number_text(output.spec->min).view() << " to "
         << number_text(output.spec->max).view();
  said << "; the last good value stands";
  const std::size_t size = std::min<std::size_t>(said.view().size(), CHIMERA_FAULT_TEXT - 1);
  std::memcpy(text, said.view().data(), size);
  text[size] = '\0';
  return false;
}

bool is_safe(const Task& task, const Output& output, char* text) noexcept {
  const PortSpec& spec = *output.spec;
  for (std::uint32_t i = 0; i < output.port->count; ++i) {
    const double value = element(*output.port, spec.type, i);
    const bool in_range = !spec.has_range || (value >= spec.min && value <= spec.max);
    if (!math::is_finite(value) || !in_range) return refuse(task, output, i, value, text);
  }
  return true;
}

}  // namespace

bool is_safe(const Task& task, char* text) noexcept {
  for (const Output& output : task.outputs)
    if (output.spec->safety && !is_safe(task, output, text)) return false;
  return true;
}

}  // namespace chimera
