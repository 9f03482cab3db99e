// SPDX-License-Identifier: Apache-2.0
// The link on the serial line of the board. A text line inside of a frame damages the frame, and Linux drops it.
#pragma once

#include <cstdint>

#include "chimera/platform/bare/serial_peer.h"
#include "firmware/boards/board.h"
#include "firmware/link/host_link.h"

namespace chimera::firmware {

/// Context of receive() and next_byte(): interrupt. Context of take(): as HostLink.
class LinkOnUart final : public HostLink, public bare::SerialPeer {
 public:
  using HostLink::HostLink;
  bool receive(std::uint8_t byte) noexcept override { return HostLink::receive(byte); }
  int next_byte() noexcept override { return HostLink::next_byte(); }
  void take(BoundarySignals& signals, Nanoseconds now) noexcept override {
    HostLink::take(signals, now);
    uart().go_on();
  }
};

}  // namespace chimera::firmware
