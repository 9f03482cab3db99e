// SPDX-License-Identifier: Apache-2.0
// ConstantStore: values by id, compared when they are set.
#include "chimera/runtime/constant_store.h"

#include <algorithm>
#include <cstring>

#include "chimera/table/slot.h"

namespace chimera {
namespace {

template <class Whole>
std::int64_t whole(const Constant& constant, std::int64_t fallback) noexcept {
  Whole n;
  if (constant.value.size() < sizeof n) return fallback;
  std::memcpy(&n, constant.value.data(), sizeof n);
  return n;
}

}  // namespace

ConstantStore::ConstantStore(const ApplicationSpec& spec, SetupMemory& memory)
    : constants_(memory.take<Constant>(spec.constants.size())) {
  const std::span<std::size_t> bytes = memory.take<std::size_t>(constants_.size());
  for (std::size_t c = 0; c < constants_.size(); ++c) bytes[c] = spec.constants[c].value.size();
  for (const TaskSpec& task : spec.tasks) {
    for (const PortSpec& port : task.ports) {
      if (!port.constant.is_valid()) continue;
      std::size_t& most = bytes[port.constant.index];
      most = std::max<std::size_t>(most, port.max_bytes());
    }
  }
  for (std::size_t c = 0; c < constants_.size(); ++c) {
    constants_[c].spec = &spec.constants[c];
    constants_[c].value = memory.take_bytes(bytes[c], kCacheLine);
    if (!spec.constants[c].value.empty()) set(ConstantId(c), spec.constants[c].value);
  }
}

bool ConstantStore::set(ConstantId id, std::span<const std::byte> value) noexcept {
  Constant& c = constants_[id.index];
  const std::size_t bytes = std::min(value.size(), c.value.size());
  const bool differs = !c.is_known || std::memcmp(c.value.data(), value.data(), bytes) != 0;
  std::memcpy(c.value.data(), value.data(), bytes);
  c.is_known = true;
  return differs;
}

std::int64_t ConstantStore::integer(ConstantId id, std::int64_t fallback) const noexcept {
  const Constant& c = constants_[id.index];
  if (c.is_known && c.spec->type == CHIMERA_INT32) return whole<std::int32_t>(c, fallback);
  if (c.is_known && c.spec->type == CHIMERA_INT64) return whole<std::int64_t>(c, fallback);
  return fallback;
}

}  // namespace chimera
