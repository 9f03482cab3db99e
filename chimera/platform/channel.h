// SPDX-License-Identifier: Apache-2.0
// A pair of sockets between two related processes: short whole messages, descriptors with them.
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "chimera/base/fixed.h"
#include "chimera/base/result.h"

namespace chimera {

/// One end of a SOCK_SEQPACKET pair. Move-only; closes. Never blocks.
class Channel {
 public:
  enum class Got : std::uint8_t { kMessage, kNothing, kClosed };

  /// Two ends, both close-on-exec. Context: setup.
  static Result<std::pair<Channel, Channel>> pair() noexcept;
  Channel() noexcept = default;
  /// Takes over an inherited descriptor. Context: setup.
  explicit Channel(int descriptor) noexcept : descriptor_(descriptor) {}
  Channel(Channel&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Channel& operator=(Channel&& other) noexcept;
  ~Channel();

  int descriptor() const noexcept { return descriptor_; }
  bool is_open() const noexcept { return descriptor_ >= 0; }
  /// Sends `bytes` whole, with one descriptor (-1: none). False when the other end is gone or its buffer is full.
  [[nodiscard]] bool send(std::span<const std::byte> bytes, int passed = -1) const noexcept;
  /// Takes the next message, which must be bytes.size() long (another length is kClosed: a stranger), and the
  /// descriptor that came with it into `passed` (-1: none), close-on-exec, the caller's to close.
  Got receive(std::span<std::byte> bytes, int& passed) const noexcept;

 private:
  int descriptor_ = -1;
};

}  // namespace chimera
