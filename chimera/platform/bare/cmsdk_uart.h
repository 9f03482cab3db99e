// SPDX-License-Identifier: Apache-2.0
// The UART of Arm's Cortex-M system design kit, which the board mps2-an385 has.
#pragma once

#include <cstdint>

#include "chimera/platform/bare/core.h"

namespace chimera::bare {

/// The port of a BareUart. Context of everything: any; wait-free.
class CmsdkUart {
 public:
  void begin(std::uintptr_t address, std::uint32_t clock_hz, std::uint32_t baud) noexcept {
    address_ = address;
    at().divider = clock_hz / baud;
    at().control = kSends | kReceives | kInterruptSent | kInterruptReceived;
  }
  bool can_send() noexcept { return (at().state & kSendFull) == 0; }
  void send(std::uint8_t byte) noexcept { at().data = byte; }
  bool has_received() noexcept { return (at().state & kReceiveFull) != 0; }
  std::uint8_t receive() noexcept { return static_cast<std::uint8_t>(at().data); }
  /// Asks for an interrupt when a byte can be sent, or not. This port interrupts once for each byte that it sent.
  void ask_to_send(bool) noexcept {}
  /// Asks for an interrupt for each byte that arrives from now on, or not.
  void ask_to_receive(bool ask) noexcept {
    at().control = ask ? at().control | kInterruptReceived : at().control & ~kInterruptReceived;
  }
  /// Call at the begin of the interrupt.
  void acknowledge() noexcept { at().interrupts = kInterrupts; }

 private:
  struct Registers {
    Register data, state, control, interrupts, divider;
  };
  static constexpr std::uint32_t kSendFull = 1, kReceiveFull = 2;
  static constexpr std::uint32_t kSends = 1, kReceives = 2, kInterruptSent = 4, kInterruptReceived = 8;
  static constexpr std::uint32_t kInterrupts = 3;
  Registers& at() noexcept { return *reinterpret_cast<Registers*>(address_); }

  std::uintptr_t address_ = 0;
};

}  // namespace chimera::bare
