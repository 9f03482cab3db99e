// SPDX-License-Identifier: Apache-2.0
// The frame that carries values to and from a device (library/serial_frame/README.md):
//
//   A5 | length | payload, `length` bytes | CRC-16 of length and payload, low byte first
//
// The CRC is CCITT-FALSE: polynomial 1021, start FFFF, nothing reflected.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace chimera::library {

inline constexpr std::uint8_t kFrameStart = 0xA5;
inline constexpr std::size_t kFrameOverhead = 4, kLongestPayload = 128;
inline constexpr std::size_t kLongestFrame = kLongestPayload + kFrameOverhead;

/// Context: any; wait-free.
constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 0x8000) != 0 ? (crc << 1) ^ 0x1021 : crc << 1);
  }
  return crc;
}

/// Completes the frame around a payload at to[2] and returns its size. Context: cycle; wait-free.
inline std::size_t close_frame(std::uint8_t* to, std::size_t payload) noexcept {
  to[0] = kFrameStart;
  to[1] = static_cast<std::uint8_t>(payload);
  const std::uint16_t crc = crc16({to + 1, payload + 1});
  to[payload + 2] = static_cast<std::uint8_t>(crc & 0xFF);
  to[payload + 3] = static_cast<std::uint8_t>(crc >> 8);
  return payload + kFrameOverhead;
}

/// Returns true if `bytes` begin with a complete frame of that payload. Context: cycle; wait-free.
inline bool is_frame(std::span<const std::uint8_t> bytes, std::size_t payload) noexcept {
  if (bytes.size() < payload + kFrameOverhead || bytes[0] != kFrameStart || bytes[1] != payload) return false;
  return crc16(bytes.subspan(1, payload + 1)) == bytes[payload + 2] + 256u * bytes[payload + 3];
}

/// Finds frames of one length in a stream of bytes that may be cut, noisy or wrong.
class FrameReader {
 public:
  /// Drops all bytes. Context: cycle; wait-free.
  void reset(std::size_t payload) noexcept {
    payload_ = payload;
    held_ = 0;
  }
  /// Buffer for the next bytes. The caller reports their number by taken(). Context: cycle; wait-free.
  std::span<std::uint8_t> room() noexcept { return std::span(bytes_).subspan(held_); }
  void taken(std::size_t count) noexcept { held_ += count; }

  /// Calls `each(payload)` for each complete frame, in order. A start byte without a frame is skipped, so it hides no
  /// frame after it. Context: cycle; wait-free, bounded by the buffer.
  template <class Each>
  void frames(Each each) noexcept {
    std::size_t at = 0;
    while (held_ - at >= 2) {
      if (bytes_[at] != kFrameStart || bytes_[at + 1] != payload_) {
        ++noise_;
        ++at;
        continue;
      }
      if (held_ - at < payload_ + kFrameOverhead) break;
      if (!is_frame(std::span(bytes_).subspan(at, held_ - at), payload_)) {
        ++wrong_;
        ++at;
        continue;
      }
      each(std::span<const std::uint8_t>(bytes_).subspan(at + 2, payload_));
      at += payload_ + kFrameOverhead;
    }
    held_ -= at;
    std::memmove(bytes_.data(), bytes_.data() + at, held_);
  }
  /// Frames with a wrong CRC, and bytes outside frames. Context: cycle; wait-free.
  std::int64_t wrong() const noexcept { return wrong_; }
  std::int64_t noise() const noexcept { return noise_; }

 private:
  std::array<std::uint8_t, 512> bytes_{};
  std::size_t held_ = 0, payload_ = 1;
  std::int64_t wrong_ = 0, noise_ = 0;
};

}  // namespace chimera::library
