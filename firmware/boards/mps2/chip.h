// SPDX-License-Identifier: Apache-2.0
// Arm MPS2 boards, images AN385 and AN386. QEMU simulates them.
#pragma once

#include "chimera/platform/bare/cmsdk_uart.h"
#include "chimera/platform/bare/cmsdk_watchdog.h"

namespace chimera::firmware {

inline constexpr unsigned kInterrupts = 32;
using UartPort = bare::CmsdkUart;
using WatchdogTimer = bare::CmsdkWatchdog;
inline constexpr unsigned kUartInterrupts[] = {0, 1};  // received, sent

/// Switches on what the image uses.
inline void begin_chip() noexcept {}

}  // namespace chimera::firmware
