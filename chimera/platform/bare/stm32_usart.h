// SPDX-License-Identifier: Apache-2.0
// The USART of the STM32F1 and F4 families.
#pragma once

#include <cstdint>

#include "chimera/platform/bare/core.h"

namespace chimera::bare {

/// The port of a BareUart. Context of everything: any; wait-free.
class Stm32Usart {
 public:
  /// The clock of the peripheral must be on.
  void begin(std::uintptr_t address, std::uint32_t clock_hz, std::uint32_t baud) noexcept {
    address_ = address;
    at().divider = clock_hz / baud;
    at().control = kEnable | kSends | kReceives | kInterruptReceived;
  }
  bool can_send() noexcept { return (at().state & kSendEmpty) != 0; }
  void send(std::uint8_t byte) noexcept { at().data = byte; }
  bool has_received() noexcept { return (at().state & kReceiveFull) != 0; }
  std::uint8_t receive() noexcept { return static_cast<std::uint8_t>(at().data); }
  /// Asks for an interrupt for each byte that arrives, or not.
  void ask_to_receive(bool ask) noexcept {
    at().control = ask ? at().control | kInterruptReceived : at().control & ~kInterruptReceived;
  }
  /// Asks for an interrupt when a byte can be sent, or not.
  void ask_to_send(bool ask) noexcept {
    at().control = ask ? at().control | kInterruptSendEmpty : at().control & ~kInterruptSendEmpty;
  }
  /// Call at the begin of the interrupt. This port clears its interrupts by reading and writing data.
  void acknowledge() noexcept {}

 private:
  struct Registers {
    Register state, data, divider, control;
  };
  static constexpr std::uint32_t kReceiveFull = 1u << 5, kSendEmpty = 1u << 7;
  static constexpr std::uint32_t kEnable = 1u << 13, kSends = 1u << 3, kReceives = 1u << 2;
  static constexpr std::uint32_t kInterruptSendEmpty = 1u << 7, kInterruptReceived = 1u << 5;
  Registers& at() noexcept { return *reinterpret_cast<Registers*>(address_); }

  std::uintptr_t address_ = 0;
};

}  // namespace chimera::bare
