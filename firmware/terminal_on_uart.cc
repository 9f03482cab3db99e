// SPDX-License-Identifier: Apache-2.0
// The line of a terminal on a board: its serial line, which then has no shell. Own lines of the image come between
// bytes of the picture, and control L brings it again.
#include "chimera/base/mechanisms.h"
#include "chimera/base/message.h"
#include "chimera/platform/bare/byte_ring.h"
#include "chimera/platform/bare/serial_peer.h"
#include "chimera/runtime/executive/baked.h"
#include "firmware/boards/board.h"
#include "library/terminal/terminal_line.h"

namespace chimera::library {

struct TerminalLine::Device final : bare::SerialPeer {
  bool receive(std::uint8_t byte) noexcept override { return in.add(byte); }
  int next_byte() noexcept override { return out.take(); }

  bare::ByteRing<64> in;
  bare::ByteRing<128> out;
};

TerminalLine::Refusal TerminalLine::open(std::string_view name, std::int32_t baud) noexcept {
  static constinit Device device;
  if (mechanisms::kShell || !mechanisms::kSerial || name != "uart")
    return std::string_view("the target gives it no 'uart'");
  const std::uint32_t of_target = baked::kTarget.uart.baud;
  if (static_cast<std::uint32_t>(baud) != of_target)
    return (Message("`baud` is ") << baud << ", and that of the target is " << of_target).view();
  if (device_ == nullptr) firmware::uart().attach(device);
  device_ = &device;
  return {};
}

void TerminalLine::flush() noexcept {
  while (device_->in.take() >= 0) {
  }
  firmware::uart().go_on();
}

int TerminalLine::read(std::span<std::uint8_t> to) noexcept {
  int n = 0;
  for (int byte = 0; static_cast<std::size_t>(n) < to.size() && (byte = device_->in.take()) >= 0;)
    to[static_cast<std::size_t>(n++)] = static_cast<std::uint8_t>(byte);
  firmware::uart().go_on();
  return n;
}

int TerminalLine::write(std::span<const std::uint8_t> from) noexcept {
  int n = 0;
  for (const std::uint8_t byte : from) n += device_->out.add(byte) ? 1 : 0;
  firmware::uart().go_on();
  return n;
}

const char* TerminalLine::loss() const noexcept { return ""; }
int TerminalLine::error() const noexcept { return 0; }
void TerminalLine::close() noexcept { device_ = nullptr; }

}  // namespace chimera::library
