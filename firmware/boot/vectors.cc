// SPDX-License-Identifier: Apache-2.0
// The way from reset to main, and the table of exceptions.
// The program uses its own stack (PSP), interrupts use another one (MSP): an overflow of the first leaves room for the
// handler that reports it.
#include <cstdint>

#include "chimera/base/mechanisms.h"
#include "chimera/platform/bare/core.h"
#include "firmware/boards/board.h"
#include "firmware/boot/stacks.h"
#include "firmware/boot/stop.h"
#include "firmware/event_interrupts.h"

extern "C" {

// Addresses from the linker script.
extern std::uint32_t image_data_source[], image_data_begin[], image_data_end[], image_bss_begin[], image_bss_end[];
extern std::uint32_t image_stack_end[], image_handler_stack_end[];

int main();

/// Runs on the stack of the program.
[[noreturn, gnu::used]] void image_begin() {
  const std::uint32_t* from = image_data_source;
  for (std::uint32_t* to = image_data_begin; to < image_data_end;) *to++ = *from++;
  for (std::uint32_t* to = image_bss_begin; to < image_bss_end;) *to++ = 0;
  chimera::firmware::guard_stacks();
  chimera::firmware::end_image(main());
}

/// The processor starts here on the stack of handlers.
[[gnu::naked]] void image_reset() {
  asm volatile(
      "ldr r0, =image_stack_end\n\t"
      "msr psp, r0\n\t"
      "movs r0, #2\n\t"
      "msr control, r0\n\t"
      "isb\n\t"
      "bl image_begin\n\t"
      ".ltorg");
}

/// Any exception that the image has no handler for. r0: what the processor stored on the stack of the program, or of
/// handlers if a handler failed.
[[gnu::naked]] void image_exception() {
  asm volatile(
      "mov r0, lr\n\t"
      "movs r1, #4\n\t"
      "tst r0, r1\n\t"
      "bne 1f\n\t"
      "mrs r0, msp\n\t"
      "b 2f\n"
      "1: mrs r0, psp\n"
      "2: mrs r1, ipsr\n\t"
      "ldr r2, =image_stop_at_exception\n\t"
      "bx r2\n\t"
      ".ltorg");
}

/// `frame` has r0 to r3, r12, lr, pc and xpsr.
[[noreturn, gnu::used]] void image_stop_at_exception(const std::uint32_t* frame, std::uint32_t number) {
  if (chimera::firmware::is_program_stack_overrun())  // the processor had no room for the frame
    chimera::firmware::stop(chimera::firmware::ResetCause::kStack, 0, "the stack of the program is too small");
  chimera::firmware::stop_at_exception(number, frame[6]);
}

}  // extern "C"

namespace chimera::firmware {
namespace {

void on_event() {
  const unsigned exception = bare::running_exception();
  if constexpr (mechanisms::kInterrupts)
    if (event_interrupts != nullptr && event_interrupts->on_interrupt(exception - 16)) return;
  stop_at_exception(exception, interrupted_program());
}

using Handler = void (*)();

struct VectorTable {
  std::uint32_t* stack;
  Handler handlers[15 + kInterrupts];
};

constexpr VectorTable vectors() {
  VectorTable table{image_handler_stack_end, {}};
  for (Handler& each : table.handlers) each = image_exception;
  table.handlers[0] = image_reset;
  table.handlers[14] = on_tick;
  for (unsigned number = 0; number < kInterrupts; ++number) table.handlers[15 + number] = on_event;
  if constexpr (mechanisms::kSerial)
    for (const unsigned number : kUartInterrupts) table.handlers[15 + number] = on_uart;
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constexpr VectorTable kVectors = vectors();

}  // namespace
}  // namespace chimera::firmware
