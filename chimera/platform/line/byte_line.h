// SPDX-License-Identifier: Apache-2.0
// A line of bytes to a device that may be gone and come back: a serial line, or UDP.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

/// Owns the descriptor. Bytes may be lost, changed and repeated on the way.
class ByteLine {
 public:
  ByteLine() = default;
  /// Opens a serial device, raw, 8 bits, no parity, one stop bit. Refuses what is no terminal, and a speed that Linux
  /// does not know. Bytes that wait in the device are dropped. Context: setup; may block.
  static Result<ByteLine> open_serial(const std::string& path, std::uint32_t baud);
  /// UDP to "HOST:PORT", with HOST an IPv4 address; "HOST:PORT@LOCAL" receives at port LOCAL of this machine. Context:
  /// setup.
  static Result<ByteLine> open_udp(const std::string& address);

  bool is_open() const noexcept { return file_.fd >= 0; }
  int descriptor() const noexcept { return file_.fd; }
  void close() noexcept { file_ = OwnedDescriptor(); }
  /// Bytes that have arrived, up to the size of `to`; 0: none. A line that is lost closes itself. Context: does not
  /// block.
  std::size_t read(std::span<std::byte> to) noexcept;
  /// Sends all bytes or a first part; a datagram is sent whole or not. A line that is lost closes itself. Context: does
  /// not block.
  std::size_t write(std::span<const std::byte> bytes) noexcept;

 private:
  OwnedDescriptor file_;
  bool is_datagram_ = false;
};

}  // namespace chimera
