// SPDX-License-Identifier: Apache-2.0
// Frames on a line that may lose, change, add and delay bytes, and that text lines share: docs/formats/link.md.
//
//   payload | CRC-32 of it  ->  COBS: no byte is zero  ->  0 ... 0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace chimera::board_link {

inline constexpr std::size_t kMostPayload = 1024, kCrcBytes = 4;
/// Bytes on the line for a payload of that size, at most: COBS adds one byte for each 254.
constexpr std::size_t line_bytes(std::size_t payload) noexcept {
  return payload + kCrcBytes + (payload + kCrcBytes) / 254 + 3;
}
inline constexpr std::size_t kMostLineBytes = line_bytes(kMostPayload);

/// CRC-32 as of Ethernet: polynomial 0xedb88320, begun and ended with all bits inverted. Context: cycle; wait-free;
/// O(bytes).
std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

/// Writes the frame of the payload, with a zero before and behind it, and returns its size. Requires: at most
/// kMostPayload bytes, and `to` holds line_bytes() of them. Context: cycle; wait-free; O(bytes).
std::size_t encode_frame(std::span<const std::byte> payload, std::span<std::byte> to) noexcept;

/// Finds the frames among the bytes of a line. What stands between two zeros and is no whole frame is dropped and
/// counted: a text line, noise, a damaged frame. No allocation.
class FrameDecoder {
 public:
  /// Takes the next byte. True if it ended a whole frame: then payload() is that of the frame until the next call.
  /// Context: any; wait-free; O(1), with a whole frame O(bytes of the frame).
  bool add(std::byte byte) noexcept;
  std::span<const std::byte> payload() const noexcept { return {bytes_.data(), payload_bytes_}; }
  /// Pieces between zeros that were no frame.
  std::uint32_t dropped() const noexcept { return dropped_; }

 private:
  void put(std::byte byte) noexcept;
  bool end() noexcept;

  std::array<std::byte, kMostPayload + kCrcBytes> bytes_{};
  std::size_t size_ = 0, payload_bytes_ = 0;
  std::uint32_t left_ = 0;        // bytes before the next byte of COBS
  std::uint32_t dropped_ = 0;
  bool owes_zero_ = false;        // before the next group, if there is one
  bool is_damaged_ = false;       // too long
  bool has_begun_ = false;        // a byte since the last zero
};

}  // namespace chimera::board_link
