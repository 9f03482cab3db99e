// SPDX-License-Identifier: Apache-2.0
// STM32F100, the chip of the board STM32VLDISCOVERY. QEMU simulates it.
#pragma once

#include "chimera/platform/bare/stm32_usart.h"
#include "chimera/platform/bare/stm32_watchdog.h"

namespace chimera::firmware {

inline constexpr unsigned kInterrupts = 61;
using UartPort = bare::Stm32Usart;
using WatchdogTimer = bare::Stm32Watchdog;
inline constexpr unsigned kUartInterrupts[] = {37};

/// Switches on the clocks of USART1 and of its pins.
inline void begin_chip() noexcept { bare::register_at(0x4002'1018) = (1u << 14) | (1u << 2) | 1u; }

}  // namespace chimera::firmware
