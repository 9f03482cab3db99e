// SPDX-License-Identifier: Apache-2.0
// The clock, the serial line and the watchdog of the image, and their interrupts.
#include "firmware/boards/board.h"

#include "chimera/base/mechanisms.h"
#include "chimera/platform/bare/core.h"
#include "chimera/runtime/executive/baked.h"
#include "firmware/boot/stacks.h"
#include "firmware/boot/stop.h"

namespace chimera::firmware {
namespace {

constinit bare::BareClock the_clock;
constinit BoardUart the_uart;
constinit BoardWatchdog the_watchdog;

}  // namespace

void begin_board() noexcept {
  begin_chip();
  const baked::TargetSpec& target = baked::kTarget;
  if constexpr (mechanisms::kSerial) {
    the_uart.begin(target.uart.address, target.clock_hz, target.uart.baud);
    for (const unsigned number : kUartInterrupts) bare::enable_interrupt(number);
  }
  the_clock.begin(bare::TickTime(target.clock_hz, baked::kRun.tick));
}

bare::BareClock& board_clock() noexcept { return the_clock; }
BoardUart& uart() noexcept { return the_uart; }
BoardWatchdog& board_watchdog() noexcept { return the_watchdog; }

void on_tick() {
  the_clock.on_tick();
  if constexpr (mechanisms::kWatchdog)
    if (the_watchdog.is_over_at_tick()) stop(ResetCause::kWatchdog, interrupted_program(), "watchdog");
}

// The idle loop looks for new bytes, and for room to send.
void on_uart() {
  the_uart.on_interrupt();
  the_clock.wake();
}

}  // namespace chimera::firmware
