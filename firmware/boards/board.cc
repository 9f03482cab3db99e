// SPDX-License-Identifier: Apache-2.0
// The clock and the serial line of the image, and their interrupts.
#include "firmware/boards/board.h"

#include "chimera/platform/bare/core.h"
#include "chimera/runtime/executive/baked.h"

namespace chimera::firmware {
namespace {

constinit bare::BareClock the_clock;
constinit BoardUart the_uart;

}  // namespace

void begin_board() noexcept {
  begin_chip();
  const baked::TargetSpec& target = baked::kTarget;
  the_uart.begin(target.uart.address, target.clock_hz, target.uart.baud);
  for (const unsigned number : kUartInterrupts) bare::enable_interrupt(number);
  the_clock.begin(bare::TickTime(target.clock_hz, baked::kRun.tick));
}

bare::BareClock& board_clock() noexcept { return the_clock; }
BoardUart& uart() noexcept { return the_uart; }
void on_tick() { the_clock.on_tick(); }
void on_uart() { the_uart.on_interrupt(); }

}  // namespace chimera::firmware
