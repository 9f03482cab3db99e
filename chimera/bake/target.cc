// SPDX-License-Identifier: Apache-2.0
// Finds interrupts, pins and resource texts of a target by their names.
#include "chimera/bake/target.h"

#include <algorithm>

namespace chimera::bake {

bool is_of_board(std::string_view port) noexcept { return port == "pin" || port == "interrupt" || port == "device"; }

std::optional<std::uint32_t> Target::interrupt(std::string_view interrupt_name) const {
  for (const NamedInterrupt& each : interrupts)
    if (each.name.text == interrupt_name) return each.number;
  return std::nullopt;
}

bool Target::has_pin(std::string_view pin_name) const {
  return std::ranges::any_of(pins, [&](const NamedPin& pin) { return pin.name.text == pin_name; });
}

const ResourceTexts* Target::resource(std::string_view task, std::string_view port) const {
  for (const ResourceTexts& each : resources)
    if (each.task.text == task && each.port.text == port) return &each;
  return nullptr;
}

const ResourceTexts* Target::user_of_uart() const {
  for (const ResourceTexts& each : resources)
    if (each.port.text == "device" && std::ranges::find(each.texts, "uart", &Word::text) != each.texts.end())
      return &each;
  return nullptr;
}

}  // namespace chimera::bake
