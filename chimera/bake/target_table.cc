// SPDX-License-Identifier: Apache-2.0
// Writes the ranges, registers and interrupts of the target as initialisers.
#include "chimera/bake/target_table.h"

#include "chimera/base/hosted/wording.h"

namespace chimera::bake {

std::string target_table(const ApplicationSpec& spec, const Target& target, Definitions& all) {
  const auto memory = [](const MemoryRange& range) {
    return "{" + std::to_string(range.address) + "u, " + std::to_string(range.bytes) + "u}";
  };
  const auto write = [](const SafeWrite& each, std::size_t) {
    return "{" + std::to_string(each.address) + "u, " + std::to_string(each.value) + "u}";
  };
  const auto pin = [](const NamedPin& each, std::size_t) {
    return "{" + literal(each.name.text) + ", " + std::to_string(each.address) + "u, " + std::to_string(each.bit) +
           "u, " + literal(each.is_output) + "}";
  };
  const auto interrupt = [](const NamedInterrupt& each, std::size_t) {
    return "{" + literal(each.name.text) + ", " + std::to_string(each.number) + "u}";
  };
  const auto event = [&](const EventLine& each, std::size_t) {
    std::size_t task = 0;
    while (task < spec.tasks.size() && spec.tasks[task].name != each.task.text) ++task;
    return "{TaskId(" + std::to_string(task) + "u), " +
           std::to_string(target.interrupt(each.interrupt.text).value_or(0)) + "u}";
  };
  const std::string uart =
      !target.uart ? ""
                    : "{" + std::to_string(target.uart->address) + "u, " +
                          std::to_string(target.interrupt(target.uart->interrupt.text).value_or(0)) + "u, " +
                          std::to_string(target.uart->baud) + "u}";
  return Initialiser()
      .add_text("name", literal(target.name))
      .add_text("board", literal(target.board))
      .add_text("cpu", literal(target.cpu))
      .add("clock_hz", target.clock_hz, std::uint32_t{0})
      .add_text("flash", memory(target.flash))
      .add_text("ram", memory(target.ram))
      .add("stack_bytes", target.stack_bytes, std::uint32_t{0})
      .add("handler_stack_bytes", target.handler_stack_bytes, std::uint32_t{0})
      .add_text("uart", uart)
      .add("watchdog", target.watchdog, {})
      .add_text("safe_writes", all.list("RegisterWrite", "kSafeWrites", target.safe_writes, write))
      .add_text("pins", all.list("TargetPin", "kPins", target.pins, pin))
      .add_text("interrupts", all.list("Interrupt", "kInterrupts", target.interrupts, interrupt))
      .add_text("events", all.list("TaskEvent", "kEvents", target.events, event))
      .text();
}

}  // namespace chimera::bake
