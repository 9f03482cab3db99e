// SPDX-License-Identifier: Apache-2.0
// Notes the form and the place of each port that a component reports while it is constructed.
#include "chimera/task/wiring.h"

namespace chimera {
namespace {

#if __STDC_HOSTED__
thread_local Wiring* current = nullptr;
#else
Wiring* current = nullptr;  // this system has one thread
#endif

}  // namespace

Wiring::Wiring(std::span<WiredPort> ports, std::span<const std::byte> state) noexcept
    : ports_(ports), state_(state), outer_(current) {
  current = this;
}

Wiring::~Wiring() { current = outer_; }

void Wiring::report(const PortForm& form, const void* live) noexcept {
  if (current != nullptr) current->add(form, static_cast<const std::byte*>(live));
}

void Wiring::add(const PortForm& form, const std::byte* live) noexcept {
  const std::size_t index = size_++;
  const std::byte* const end = state_.data() + state_.size();
  if (live < state_.data() || live >= end) is_inside_ = false;
  else if (index < ports_.size()) ports_[index] = {&form, static_cast<std::uint32_t>(live - state_.data())};
}

}  // namespace chimera
