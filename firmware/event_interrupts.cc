// SPDX-License-Identifier: Apache-2.0
// Counts interrupts, and switches their lines.
#include "firmware/event_interrupts.h"

#include "chimera/platform/bare/core.h"

namespace chimera::firmware {

constinit EventInterrupts* event_interrupts = nullptr;

EventInterrupts::EventInterrupts(std::span<const baked::TaskEvent> events, SetupMemory& memory)
    : lines_(memory.take<Line>(events.size())) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    lines_[i].counter.lead_to(events[i].task);
    lines_[i].number = events[i].interrupt;
  }
}

std::uint32_t EventInterrupts::take(const Task& task, bool waits) noexcept {
  std::uint32_t fresh = 0;
  for (Line& line : lines_) {
    if (line.counter.task() != task.id) continue;
    const std::uint32_t events = line.counter.take();
    fresh += events;
    const bool is_answered = events == 0 && !waits && task.state == State::kOn;
    if (!is_answered || !line.is_switched_off.load(std::memory_order_relaxed)) continue;
    line.is_switched_off.store(false, std::memory_order_relaxed);
    std::atomic_signal_fence(std::memory_order_seq_cst);  // the interrupt may come with the next instruction
    bare::enable_interrupt(line.number);
  }
  return fresh;
}

bool EventInterrupts::on_interrupt(unsigned number) noexcept {
  for (Line& line : lines_) {
    if (line.number != number) continue;
    bare::disable_interrupt(number);
    line.is_switched_off.store(true, std::memory_order_relaxed);
    line.counter.count();
    return true;
  }
  return false;
}

}  // namespace chimera::firmware
