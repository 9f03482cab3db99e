// SPDX-License-Identifier: Apache-2.0
// Measures the step between two values of a variable, element by element.
#include "chimera/runtime/value_step.h"

#include <cstring>

namespace chimera {
namespace {

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

// Three values of one place: before, after, and the limit there, null where there is none.
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

}  // namespace chimera
