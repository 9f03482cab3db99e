// SPDX-License-Identifier: Apache-2.0
// The chip of the image for the rest of the firmware. CHIMERA_BOARD is the path of the file chip.h of a board. The
// other numbers are in chimera::baked::kTarget.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/platform/bare/bare_clock.h"
#include "chimera/platform/bare/bare_uart.h"
#include "firmware/boards/board_watchdog.h"
#include CHIMERA_BOARD

namespace chimera::firmware {

inline constexpr std::size_t kSendBytes = 256;
using BoardUart = bare::BareUart<UartPort, kSendBytes>;

/// Starts the clock and the serial line. Context: setup.
void begin_board() noexcept;
/// The clock of the image. Context: any.
bare::BareClock& board_clock() noexcept;
/// The serial line of the image: 8 bits, no parity. Context: any.
BoardUart& uart() noexcept;
/// The watchdog of the chip. Context: any.
BoardWatchdog& board_watchdog() noexcept;

// Interrupts.
void on_tick();
void on_uart();

}  // namespace chimera::firmware
