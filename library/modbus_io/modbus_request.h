// SPDX-License-Identifier: Apache-2.0
// A Modbus request as bytes, and the answer that belongs to it. The guard sends write requests, too, after the death of
// the process.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace chimera::library {

/// Bytes, judged as the answer to a request.
enum class ModbusAnswer { kIncomplete, kGood, kRefusal, kForeign };

/// Modbus is big-endian, except for the check of a serial line. Context of all: any; wait-free.
class ModbusRequest {
 public:
  static constexpr std::size_t kMost = 64;  // bytes of a request or an answer, for at most 18 registers

  static ModbusRequest read(bool is_tcp, int unit, std::uint8_t function, int first, std::size_t count) noexcept {
    ModbusRequest made(is_tcp, unit, function, first, count);
    const bool is_bits = function <= 2;
    made.answer_bytes_ = is_bits ? (count + 7) / 8 : 2 * count;
    return made.closed();
  }
  /// Writes `values` to the points from `first` on.
  static ModbusRequest registers(bool is_tcp, int unit, int first, std::span<const std::uint16_t> values) noexcept {
    ModbusRequest made(is_tcp, unit, 0x10, first, values.size());
    made.put(static_cast<std::uint8_t>(2 * values.size()));
    for (const std::uint16_t value : values) made.put16(value);
    return made.closed();
  }
  static ModbusRequest coils(bool is_tcp, int unit, int first, std::span<const std::uint8_t> values) noexcept {
    ModbusRequest made(is_tcp, unit, 0x0F, first, values.size());
    made.put(static_cast<std::uint8_t>((values.size() + 7) / 8));
    for (std::size_t i = 0; i < values.size(); i += 8) {
      std::uint8_t eight = 0;
      for (std::size_t bit = 0; bit < 8 && i + bit < values.size(); ++bit)
        eight = static_cast<std::uint8_t>(eight | (values[i + bit] != 0 ? 1u << bit : 0u));
      made.put(eight);
    }
    return made.closed();
  }
  std::span<const std::uint8_t> bytes() const noexcept { return {bytes_, size_}; }
  /// Numbers the request. Only TCP has a place for it.
  void number(std::uint16_t number) noexcept {
    if (head_ == 0) return;
    bytes_[0] = static_cast<std::uint8_t>(number >> 8);
    bytes_[1] = static_cast<std::uint8_t>(number & 0xFF);
  }

  /// Bytes of the answer if the device does as told.
  std::size_t answer_size() const noexcept { return head_ + (is_read() ? 3 + answer_bytes_ : 6) + check_bytes(); }
  /// Judges all bytes that have come so far: number, unit, function, length, place and check belong to this request.
  ModbusAnswer judge(std::span<const std::uint8_t> answer) const noexcept {
    if (answer.size() < head_ + 3) return ModbusAnswer::kIncomplete;
    const std::uint8_t function = answer[head_ + 1];
    const bool refuses = function == (bytes_[head_ + 1] | 0x80);
    const std::size_t size = refuses ? head_ + 3 + check_bytes() : answer_size();
    if (answer.size() < size) return ModbusAnswer::kIncomplete;
    const bool is_framed = head_ == 0 ? has_check(answer.first(size))
                                      : has_equal(answer, 0, 4) && 256u * answer[4] + answer[5] + 6 == size;
    if (answer.size() != size || !is_framed || answer[head_] != bytes_[head_]) return ModbusAnswer::kForeign;
    if (refuses) return ModbusAnswer::kRefusal;
    const bool is_ours = function == bytes_[head_ + 1] &&
                         (is_read() ? answer[head_ + 2] == answer_bytes_ : has_equal(answer, head_ + 2, 4));
    return is_ours ? ModbusAnswer::kGood : ModbusAnswer::kForeign;
  }
  /// The code of a refusal: 1 to 11.
  std::uint8_t refusal(std::span<const std::uint8_t> answer) const noexcept { return answer[head_ + 2]; }
  /// Value `i` of a good answer to a read request.
  std::uint16_t register_at(std::span<const std::uint8_t> answer, std::size_t i) const noexcept {
    return static_cast<std::uint16_t>(256u * answer[head_ + 3 + 2 * i] + answer[head_ + 4 + 2 * i]);
  }
  bool bit_at(std::span<const std::uint8_t> answer, std::size_t i) const noexcept {
    return (answer[head_ + 3 + i / 8] >> (i % 8) & 1) != 0;
  }

 private:
  ModbusRequest(bool is_tcp, int unit, std::uint8_t function, int first, std::size_t count) noexcept
      : head_(is_tcp ? 6 : 0) {
    for (std::size_t i = 0; i < head_; ++i) put(0);
    put(static_cast<std::uint8_t>(unit));
    put(function);
    put16(static_cast<std::uint16_t>(first));
    put16(static_cast<std::uint16_t>(count));
  }
  bool has_equal(std::span<const std::uint8_t> answer, std::size_t from, std::size_t count) const noexcept {
    return std::equal(bytes_ + from, bytes_ + from + count, answer.data() + from);
  }
  bool is_read() const noexcept { return bytes_[head_ + 1] <= 4; }
  std::size_t check_bytes() const noexcept { return head_ == 0 ? 2 : 0; }
  static std::uint16_t check_of(std::span<const std::uint8_t> bytes) noexcept {
    std::uint16_t check = 0xFFFF;
    for (const std::uint8_t byte : bytes) {
      check = static_cast<std::uint16_t>(check ^ byte);
      for (int bit = 0; bit < 8; ++bit)
        check = static_cast<std::uint16_t>((check >> 1) ^ ((check & 1) != 0 ? 0xA001 : 0));
    }
    return check;
  }
  static bool has_check(std::span<const std::uint8_t> bytes) noexcept {
    const std::size_t n = bytes.size() - 2;
    return check_of(bytes.first(n)) == bytes[n] + 256u * bytes[n + 1];
  }
  ModbusRequest& closed() noexcept {
    if (head_ != 0) {
      bytes_[5] = static_cast<std::uint8_t>(size_ - 6);
      return *this;
    }
    const std::uint16_t check = check_of(bytes());
    put(static_cast<std::uint8_t>(check & 0xFF));
    put(static_cast<std::uint8_t>(check >> 8));
    return *this;
  }
  void put(std::uint8_t byte) noexcept { bytes_[size_++] = byte; }
  void put16(std::uint16_t word) noexcept {
    put(static_cast<std::uint8_t>(word >> 8));
    put(static_cast<std::uint8_t>(word & 0xFF));
  }

  std::uint8_t bytes_[kMost];
  std::size_t size_ = 0, head_;
  std::size_t answer_bytes_ = 0;  // of the values, if it reads
};

}  // namespace chimera::library
