// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/constant_store.h"

#include <algorithm>
#include <cstring>

namespace chimera {

std::size_t ConstantStore::declare(std::string_view name, std::uint32_t type, std::size_t bytes) {
  for (std::size_t i = 0; i < constants_.size(); ++i) {
    if (constants_[i].name != name) continue;
    if (constants_[i].value.size() < bytes) constants_[i].value.resize(bytes);
    return i;
  }
  Constant made;
  made.name = name;
  made.type = type;
  made.value.resize(bytes);
  constants_.push_back(std::move(made));
  return constants_.size() - 1;
}

const Constant* ConstantStore::find(std::string_view name) const noexcept {
  for (const Constant& c : constants_)
    if (c.name == name) return &c;
  return nullptr;
}

bool ConstantStore::set(std::string_view name, std::span<const std::byte> value, TaskId producer) noexcept {
  for (Constant& c : constants_) {
    if (c.name != name) continue;
    const std::size_t bytes = std::min(value.size(), c.value.size());
    const bool differs = !c.is_known || std::memcmp(c.value.data(), value.data(), bytes) != 0;
    std::memcpy(c.value.data(), value.data(), bytes);
    c.is_known = true;
    c.producer = producer;
    return differs;
  }
  return false;
}

std::int64_t ConstantStore::integer(std::string_view name, std::int64_t fallback) const noexcept {
  const Constant* c = find(name);
  if (c == nullptr || !c->is_known) return fallback;
  if (c->type == CHIMERA_INT32) {
    std::int32_t n;
    std::memcpy(&n, c->value.data(), sizeof n);
    return n;
  }
  if (c->type == CHIMERA_INT64) {
    std::int64_t n;
    std::memcpy(&n, c->value.data(), sizeof n);
    return n;
  }
  return fallback;
}

}  // namespace chimera
