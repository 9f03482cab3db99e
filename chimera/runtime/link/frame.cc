// SPDX-License-Identifier: Apache-2.0
// CRC-32 four bits at a time, and COBS (Cheshire & Baker 1999): each zero becomes the distance to the next one.
#include "chimera/runtime/link/frame.h"

#include "chimera/base/assert.h"

namespace chimera::board_link {
namespace {

/// The CRC of each value of four bits: 64 bytes of flash in place of 1 KiB.
constexpr std::array<std::uint32_t, 16> make_nibbles() noexcept {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t n = 0; n < 16; ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 4; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    table[n] = crc;
  }
  return table;
}
constexpr std::array<std::uint32_t, 16> kNibbles = make_nibbles();

constexpr std::uint32_t kLongestGroup = 0xff;  // 254 bytes and no zero behind them

std::uint32_t little_endian(const std::byte* at) noexcept {
  std::uint32_t word = 0;
  for (int i = 3; i >= 0; --i) word = word << 8 | std::to_integer<std::uint32_t>(at[i]);
  return word;
}

/// Adds bytes to a frame; no byte of it is zero.
class Stuffing {
 public:
  explicit Stuffing(std::span<std::byte> to) noexcept : to_(to) {}

  void add(std::byte byte) noexcept {
    if (byte != std::byte{0}) to_[size_++] = byte;
    if (byte == std::byte{0} || size_ - group_ == kLongestGroup) next_group();
  }
  /// Closes the last group and adds the zero behind the frame.
  std::size_t end() noexcept {
    close_group();
    to_[size_++] = std::byte{0};
    return size_;
  }

 private:
  void close_group() noexcept { to_[group_] = static_cast<std::byte>(size_ - group_); }
  void next_group() noexcept {
    close_group();
    group_ = size_++;
  }

  std::span<std::byte> to_;
  std::size_t group_ = 1, size_ = 2;  // behind the first zero
};

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes) noexcept {
  std::uint32_t crc = 0xffffffffu;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    crc = crc >> 4 ^ kNibbles[crc & 15];
    crc = crc >> 4 ^ kNibbles[crc & 15];
  }
  return ~crc;
}

std::size_t encode_frame(std::span<const std::byte> payload, std::span<std::byte> to) noexcept {
  CHIMERA_ASSERT(payload.size() <= kMostPayload && to.size() >= line_bytes(payload.size()));
  to[0] = std::byte{0};
  Stuffing frame(to);
  for (const std::byte byte : payload) frame.add(byte);
  const std::uint32_t crc = crc32(payload);
  for (int i = 0; i < 4; ++i) frame.add(static_cast<std::byte>(crc >> 8 * i));
  return frame.end();
}

void FrameDecoder::put(std::byte byte) noexcept {
  if (size_ == bytes_.size()) is_damaged_ = true;
  else bytes_[size_++] = byte;
}

bool FrameDecoder::add(std::byte byte) noexcept {
  if (byte == std::byte{0}) return end();
  has_begun_ = true;
  if (is_damaged_) return false;
  if (left_ == 0) {
    if (owes_zero_) put(std::byte{0});
    left_ = std::to_integer<std::uint32_t>(byte);
    owes_zero_ = left_ != kLongestGroup;
  } else {
    put(byte);
  }
  --left_;
  return false;
}

bool FrameDecoder::end() noexcept {
  const std::span<const std::byte> all(bytes_.data(), size_);
  bool is_whole = has_begun_ && !is_damaged_ && left_ == 0 && all.size() > kCrcBytes;
  if (is_whole) {
    payload_bytes_ = all.size() - kCrcBytes;
    is_whole = crc32(all.first(payload_bytes_)) == little_endian(all.data() + payload_bytes_);
  }
  if (has_begun_ && !is_whole) ++dropped_;
  size_ = left_ = 0;
  owes_zero_ = is_damaged_ = has_begun_ = false;
  return is_whole;
}

}  // namespace chimera::board_link
