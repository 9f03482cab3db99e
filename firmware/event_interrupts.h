// SPDX-License-Identifier: Apache-2.0
// Interrupts of the chip that release jobs: `events` of a target.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/executive/baked.h"
#include "chimera/runtime/life/event_inputs.h"

namespace chimera::firmware {

/// Counts each interrupt and switches its line off, because a device may hold the line until `sync` of the task has
/// dealt with it. The line is on again from the tick on at which the task is ON and has answered all its events. An
/// interrupt that comes before then waits in the interrupt controller, or in its device.
class EventInterrupts final : public EventInputs {
 public:
  /// `events` outlive this. Context: setup.
  EventInterrupts(std::span<const baked::TaskEvent> events, SetupMemory& memory);
  EventInterrupts(const EventInterrupts&) = delete;
  EventInterrupts& operator=(const EventInterrupts&) = delete;

  /// Context: between jobs; wait-free; O(lines).
  std::uint32_t take(const Task& task, bool waits) noexcept override;
  /// False: no task has this interrupt of the chip. Context: interrupt; wait-free.
  bool on_interrupt(unsigned number) noexcept;

 private:
  struct Line {
    InterruptLine counter;
    std::uint32_t number = 0;                // of the interrupt
    std::atomic<bool> is_switched_off{true};  // relaxed: the interrupt cannot come while the program writes it
  };

  std::span<Line> lines_;
};

/// The only one of the image; null: there is none.
extern EventInterrupts* event_interrupts;

}  // namespace chimera::firmware
