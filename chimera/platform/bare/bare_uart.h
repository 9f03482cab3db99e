// SPDX-License-Identifier: Apache-2.0
// A serial line with a ring of bytes to send; interrupts move the bytes. A peer shares the line, line by line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "chimera/platform/bare/byte_ring.h"
#include "chimera/platform/bare/core.h"
#include "chimera/platform/bare/serial_peer.h"

namespace chimera::bare {

/// `Port` is CmsdkUart or Stm32Usart.
template <class Port, std::size_t kSendBytes>
class BareUart {
 public:
  /// Context: setup. The interrupt of the port is enabled by the caller.
  void begin(std::uintptr_t address, std::uint32_t clock_hz, std::uint32_t baud) noexcept {
    port_.begin(address, clock_hz, baud);
  }
  /// The peer gets all bytes that arrive, and its lines go out between those of send(). It outlives this. Without a
  /// peer, bytes that arrive are dropped. Context: setup.
  void attach(SerialPeer& peer) noexcept {
    NoInterrupts off;
    peer_ = &peer;
  }
  /// Sends the text later, or nothing of it, and counts it as lost, if it does not fit in. From the first byte of a
  /// line on, the peer waits for its '\n'. Context: cycle; wait-free.
  bool send(std::string_view text) noexcept {
    NoInterrupts off;
    pump();
    if (ring_out_.free() < text.size()) return ++lost_out_, false;
    for (const char c : text) put(static_cast<std::uint8_t>(c));
    pump();
    return true;
  }
  /// The peer may have a line to send, or room for bytes again. Context: cycle; wait-free.
  void go_on() noexcept {
    NoInterrupts off;
    if (is_held_) {
      port_.ask_to_receive(true);
      take_in();  // a byte that arrived before interrupts no more
    }
    pump();
  }
  /// Waits until all texts of send() are sent. Context: setup; blocks.
  void flush() noexcept {
    while (ring_out_.size() != 0) go_on();
  }
  /// Call from the interrupts of the port. Context: interrupt; wait-free.
  void on_interrupt() noexcept {
    port_.acknowledge();
    take_in();
    pump();
  }
  /// Texts of send() that did not fit in. Context: any; wait-free.
  std::uint32_t lost_out() const noexcept { return lost_out_; }

 private:
  enum class Line : std::uint8_t { kNone, kOwn, kOfPeer };

  // A line that sends faster than the peer reads interrupts no more until go_on(): it takes no time from the jobs.
  void take_in() noexcept {
    if (!port_.has_received()) return;
    const std::uint8_t byte = port_.receive();
    is_held_ = peer_ != nullptr && !peer_->receive(byte);
    if (is_held_) port_.ask_to_receive(false);
  }
  // Most lines find the port idle: then no byte takes the way through the ring.
  void put(std::uint8_t byte) noexcept {
    if (line_ == Line::kOfPeer || ring_out_.size() != 0 || !port_.can_send()) {
      ring_out_.add(byte);
      return;
    }
    line_ = byte == '\n' ? Line::kNone : Line::kOwn;
    port_.send(byte);
  }
  void pump() noexcept {
    bool is_full = false;
    for (int byte = 0; !(is_full = !port_.can_send()) && (byte = next()) >= 0;)
      port_.send(static_cast<std::uint8_t>(byte));
    port_.ask_to_send(is_full);
  }
  // One source until the end of its line. Own lines come first, because the program does not wait for the peer.
  int next() noexcept {
    int byte = line_ == Line::kOfPeer ? -1 : ring_out_.take();
    if (byte >= 0) line_ = byte == '\n' ? Line::kNone : Line::kOwn;
    if (byte >= 0 || line_ == Line::kOwn || peer_ == nullptr) return byte;
    byte = peer_->next_byte();
    line_ = byte < 0 || byte == '\n' ? Line::kNone : Line::kOfPeer;
    return byte;
  }

  Port port_;
  ByteRing<kSendBytes> ring_out_;
  SerialPeer* peer_ = nullptr;
  std::uint32_t lost_out_ = 0;
  bool is_held_ = false;  // the port does not interrupt for bytes that arrive
  Line line_ = Line::kNone;
};

}  // namespace chimera::bare
