// SPDX-License-Identifier: Apache-2.0
// The application in an image for a microcontroller. `chimera bake` writes tables.cc, which defines every object that
// this header declares (docs/formats/baked.md). All of them are constant and lie in flash.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/cycle/script.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/task/abi.h"

namespace chimera::baked {

/// How the executive runs the application.
struct Run {
  Policy policy = Policy::kEdf;     ///< rm, edf or muf
  Nanoseconds tick;                 ///< between two interrupts of the timer; every period and offset is a multiple
  Nanoseconds duration = kNever;    ///< of the run; kNever: it does not end by itself
  std::span<const ScriptAct> acts;  ///< in order of time
  Nanoseconds link_period;          ///< between two frames to Linux (docs/formats/link.md); 0: no link
  Nanoseconds link_stale_after;     ///< without a frame for this time values from Linux are not valid
};

/// A range of addresses.
struct Memory {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
};

/// One 32-bit store.
struct RegisterWrite {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};

/// An interrupt line of the chip, as its interrupt controller counts: 0 is the first line behind the core's own.
struct Interrupt {
  std::string_view name;
  std::uint32_t number = 0;
};

/// One bit of a 32-bit register.
struct TargetPin {
  std::string_view name;
  std::uint32_t address = 0;  ///< of the register
  std::uint32_t bit = 0;      ///< 0 to 31
  bool is_output = false;     ///< the application may write it
};

/// The serial line of the shell and of the output.
struct Uart {
  std::uint32_t address = 0;               ///< of its registers; 0: the target has none
  std::uint32_t interrupt = UINT32_MAX;    ///< of a received byte
  std::uint32_t baud = 0;
};

/// A task whose events come from an interrupt.
struct TaskEvent {
  TaskId task;
  std::uint32_t interrupt = 0;  ///< Interrupt::number
};

/// Chip and board (docs/formats/target.md). Addresses are those of the memory map of the chip.
struct TargetSpec {
  std::string_view name;   ///< of the file, without its extension
  std::string_view board;  ///< a folder of firmware/boards
  std::string_view cpu;    ///< "cortex-m3"
  std::uint32_t clock_hz = 0;
  Memory flash, ram;
  std::uint32_t stack_bytes = 0;          ///< of the thread that runs the tasks
  std::uint32_t handler_stack_bytes = 0;  ///< of interrupts
  Uart uart;
  Nanoseconds watchdog;  ///< from a stroke to the interrupt of the watchdog; 0: the target has no watchdog
  std::span<const RegisterWrite> safe_writes;  ///< in the order in which a failed image does them
  std::span<const TargetPin> pins;
  std::span<const Interrupt> interrupts;
  std::span<const TaskEvent> events;  ///< at most one for each task
};

extern const ApplicationSpec kSpec;
/// The component of each task, in the order of kSpec.tasks. A missing component is an undefined reference at the link.
extern const std::span<const chimera_component* const> kComponents;
extern const Run kRun;
extern const TargetSpec kTarget;

}  // namespace chimera::baked
