// SPDX-License-Identifier: Apache-2.0
// Compares extents with the constants that fix them.
#include "chimera/bake/room.h"

#include <algorithm>
#include <cstring>

namespace chimera::bake {
namespace {

using Bytes = std::span<const std::byte>;

template <class Whole>
std::int64_t whole(Bytes bytes) noexcept {
  Whole n;
  if (bytes.size() < sizeof n) return 0;
  std::memcpy(&n, bytes.data(), sizeof n);
  return n;
}

/// The value of a whole constant that the description gives; 0 for others.
std::int64_t given(const ConstantSpec& constant) noexcept {
  if (!constant.producers.empty()) return 0;
  if (constant.type == CHIMERA_INT32) return whole<std::int32_t>(constant.value);
  return constant.type == CHIMERA_INT64 ? whole<std::int64_t>(constant.value) : 0;
}

/// The number of elements, if that is less than `extent` has room for; 0: the room stays.
std::uint32_t fitted(const ExtentSpec (&extent)[CHIMERA_MAX_EXTENTS], const ApplicationSpec& spec) noexcept {
  if (!extent[0].constant.is_valid() || extent[1].constant.is_valid() || extent[1].max != 1) return 0;
  const std::int64_t n = given(spec.constants[extent[0].constant.index]);
  return n >= 1 && n < extent[0].max ? static_cast<std::uint32_t>(n) : 0;
}

Bytes first(Bytes bytes, std::size_t n) noexcept { return bytes.first(std::min(n, bytes.size())); }

}  // namespace

void fit(PortSpec& port, const ApplicationSpec& spec) noexcept {
  const std::uint32_t n = fitted(port.extent, spec);
  if (n == 0) return;
  port.max_step = first(port.max_step, port.max_step.size() / port.extent[0].max * n);
  port.value = first(port.value, std::size_t{n} * port.element_bytes);
  port.extent[0].max = n;
}

void fit(GivenSpec& given, const ApplicationSpec& spec) noexcept {
  const std::uint32_t n = fitted(given.extent, spec);
  if (n == 0) return;
  given.value = first(given.value, std::size_t{n} * given.element_bytes);
  given.extent[0].max = n;
}

void fit(ConstantSpec& constant, ConstantId id, const ApplicationSpec& spec) noexcept {
  std::size_t most = 0;
  for (const TaskSpec& task : spec.tasks)
    for (const PortSpec& port : task.ports)
      if (port.constant == id) most = std::max<std::size_t>(most, port.max_bytes());
  if (most > 0) constant.value = first(constant.value, most);
}

}  // namespace chimera::bake
