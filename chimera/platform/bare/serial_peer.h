// SPDX-License-Identifier: Apache-2.0
// The part of an image that reads from a serial line and writes whole lines of its own to it.
#pragma once

#include <cstdint>

namespace chimera::bare {

/// Context of everything: interrupt, or with interrupts off; wait-free.
class SerialPeer {
 public:
  /// A byte arrived; false if there is no room for it. Then no byte comes until BareUart::go_on().
  virtual bool receive(std::uint8_t byte) noexcept = 0;
  /// The next byte to send; -1: there is none. From the first byte of a line on, all bytes up to its '\n' are there.
  virtual int next_byte() noexcept = 0;

 protected:
  ~SerialPeer() = default;
};

}  // namespace chimera::bare
