// SPDX-License-Identifier: Apache-2.0
// Pins of the target as digital inputs of components: a bit of a register.
#include "chimera/base/message.h"
#include "chimera/platform/bare/core.h"
#include "chimera/runtime/executive/baked.h"
#include "library/button/input_pin.h"

namespace chimera::library {

InputPin::Refusal InputPin::open(std::string_view name) noexcept {
  close();
  for (std::size_t i = 0; i < baked::kTarget.pins.size(); ++i) {
    if (baked::kTarget.pins[i].name != name) continue;
    if (baked::kTarget.pins[i].is_output) return (Message("the target has ") << name << " for writing").view();
    handle_ = static_cast<int>(i);
    return {};
  }
  return (Message("the target has no pin ") << name).view();
}

InputPin::Level InputPin::read() const noexcept {
  if (handle_ < 0) return Level::kUnreadable;
  const baked::TargetPin& pin = baked::kTarget.pins[static_cast<std::size_t>(handle_)];
  return (bare::register_at(pin.address) >> pin.bit & 1u) != 0 ? Level::kHigh : Level::kLow;
}

void InputPin::close() noexcept { handle_ = -1; }

}  // namespace chimera::library
