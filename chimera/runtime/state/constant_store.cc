// SPDX-License-Identifier: Apache-2.0
// ConstantStore: values by id and producer, compared when they are set.
#include "chimera/runtime/state/constant_store.h"

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

ConstantStore::ConstantStore(const ApplicationSpec& spec, SetupMemory& memory) {
  if constexpr (!mechanisms::kConstants) {
    take_given(spec, memory);
    return;
  }
  first_ = memory.take<std::uint32_t>(spec.constants.size());
  counts_ = memory.take<std::uint32_t>(spec.constants.size());
  const std::span<std::size_t> bytes = memory.take<std::size_t>(first_.size());
  std::size_t n = 0;
  for (std::size_t c = 0; c < first_.size(); ++c) {
    bytes[c] = spec.constants[c].value.size();
    first_[c] = counts_[c] = static_cast<std::uint32_t>(n);
    n += std::max<std::size_t>(spec.constants[c].producers.size(), 1);
  }
  for (const TaskSpec& task : spec.tasks) {
    for (const PortSpec& port : task.ports) {
      if (!port.constant.is_valid()) continue;
      std::size_t& most = bytes[port.constant.index];
      most = std::max<std::size_t>(most, port.max_bytes());
    }
  }
  made_ = memory.take<Constant>(n);
  for (std::size_t c = 0; c < first_.size(); ++c) {
    const std::size_t end = c + 1 < first_.size() ? first_[c + 1] : n;
    for (std::size_t m = first_[c]; m < end; ++m) {
      made_[m].spec = &spec.constants[c];
      made_[m].value = memory.take_bytes(bytes[c], kCacheLine);
    }
    if (!spec.constants[c].value.empty()) set(ConstantId(c), 0, spec.constants[c].value);
  }
}

void ConstantStore::take_given(const ApplicationSpec& spec, SetupMemory& memory) {
  made_ = memory.take<Constant>(spec.constants.size());
  for (std::size_t c = 0; c < made_.size(); ++c) {
    const std::span<const std::byte> value = spec.constants[c].value;
    made_[c] = {&spec.constants[c], {const_cast<std::byte*>(value.data()), value.size()}, !value.empty()};
  }
}

bool ConstantStore::set(ConstantId id, std::uint32_t producer, std::span<const std::byte> value) noexcept {
  Constant& c = made_[first_[id.index] + producer];
  const std::size_t bytes = std::min(value.size(), c.value.size());
  const bool differs = !c.is_known || std::memcmp(c.value.data(), value.data(), bytes) != 0;
  std::memcpy(c.value.data(), value.data(), bytes);
  c.is_known = true;
  return differs;
}

bool ConstantStore::set_by(TaskId producer, ConstantId id, std::span<const std::byte> value) noexcept {
  const std::span<const PortOf> producers = made_[first_[id.index]].spec->producers;
  std::uint32_t k = 0;
  while (k + 1 < producers.size() && producers[k].task != producer) ++k;
  return set(id, k, value);
}

std::int64_t ConstantStore::integer(ConstantId id, std::int64_t fallback) const noexcept {
  const Constant& c = (*this)[id];
  if (c.is_known && c.spec->type == CHIMERA_INT32) return whole<std::int32_t>(c, fallback);
  if (c.is_known && c.spec->type == CHIMERA_INT64) return whole<std::int64_t>(c, fallback);
  return fallback;
}

}  // namespace chimera
