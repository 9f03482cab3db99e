// SPDX-License-Identifier: Apache-2.0
// A serial line with a ring of bytes in each direction; interrupts move the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "chimera/platform/bare/byte_ring.h"
#include "chimera/platform/bare/core.h"

namespace chimera::bare {

/// `Port` is CmsdkUart or Stm32Usart.
template <class Port, std::size_t kSendBytes, std::size_t kReceiveBytes>
class BareUart {
 public:
  /// Context: setup. The interrupt of the port is enabled by the caller.
  void begin(std::uintptr_t address, std::uint32_t clock_hz, std::uint32_t baud) noexcept {
    port_.begin(address, clock_hz, baud);
  }
  /// Sends the whole text later, or nothing of it, and counts it as lost, if it does not fit in. Context: cycle;
  /// wait-free.
  bool send(std::string_view text) noexcept {
    NoInterrupts off;
    pump();
    if (ring_out_.free() < text.size()) return ++lost_out_, false;
    for (const char c : text) ring_out_.add(static_cast<std::uint8_t>(c));
    pump();
    return true;
  }
  /// The next received byte; -1: none. Context: cycle; wait-free.
  int receive() noexcept { return ring_in_.take(); }
  /// Waits until everything is sent. Context: setup; blocks.
  void flush() noexcept {
    while (ring_out_.size() != 0) {
      NoInterrupts off;
      pump();
    }
  }
  /// Call from the interrupts of the port. Context: interrupt; wait-free.
  void on_interrupt() noexcept {
    port_.acknowledge();
    while (port_.has_received())
      if (!ring_in_.add(port_.receive())) ++lost_in_;
    pump();
  }
  /// Texts that did not fit in, and received bytes that did not. Context: any; wait-free.
  std::uint32_t lost_out() const noexcept { return lost_out_; }
  std::uint32_t lost_in() const noexcept { return lost_in_; }

 private:
  void pump() noexcept {
    while (ring_out_.size() != 0 && port_.can_send()) port_.send(static_cast<std::uint8_t>(ring_out_.take()));
    port_.ask_to_send(ring_out_.size() != 0);
  }

  Port port_;
  ByteRing<kSendBytes> ring_out_;
  ByteRing<kReceiveBytes> ring_in_;
  std::uint32_t lost_out_ = 0, lost_in_ = 0;
};

}  // namespace chimera::bare
