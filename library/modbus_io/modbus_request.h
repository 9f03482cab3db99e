// SPDX-License-Identifier: Apache-2.0
// Write requests as bytes, for the guard, which sends them after the death of the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace chimera::library {

/// One request in `bytes`. Modbus is big-endian, except for the check of a serial line.
class ModbusRequest {
 public:
  /// Writes `values` to the points from `first` on. Context: any; wait-free.
  static ModbusRequest registers(bool is_tcp, int unit, int first, std::span<const std::uint16_t> values) noexcept {
    ModbusRequest made(is_tcp, unit, 0x10, first, values.size(), 2 * values.size());
    for (const std::uint16_t value : values) made.put16(value);
    return made.closed(is_tcp);
  }
  static ModbusRequest coils(bool is_tcp, int unit, int first, std::span<const std::uint8_t> values) noexcept {
    ModbusRequest made(is_tcp, unit, 0x0F, first, values.size(), (values.size() + 7) / 8);
    for (std::size_t i = 0; i < values.size(); i += 8) {
      std::uint8_t eight = 0;
      for (std::size_t bit = 0; bit < 8 && i + bit < values.size(); ++bit)
        eight = static_cast<std::uint8_t>(eight | (values[i + bit] != 0 ? 1u << bit : 0u));
      made.put(eight);
    }
    return made.closed(is_tcp);
  }
  std::span<const std::uint8_t> bytes() const noexcept { return {bytes_, size_}; }

 private:
  ModbusRequest(bool is_tcp, int unit, std::uint8_t function, int first, std::size_t count,
                std::size_t behind) noexcept {
    if (is_tcp) {
      put16(0);  // transaction
      put16(0);  // protocol
      put16(static_cast<std::uint16_t>(7 + behind));
    }
    put(static_cast<std::uint8_t>(unit));
    put(function);
    put16(static_cast<std::uint16_t>(first));
    put16(static_cast<std::uint16_t>(count));
    put(static_cast<std::uint8_t>(behind));
  }
  ModbusRequest& closed(bool is_tcp) noexcept {
    if (is_tcp) return *this;
    std::uint16_t check = 0xFFFF;
    for (std::size_t i = 0; i < size_; ++i) {
      check = static_cast<std::uint16_t>(check ^ bytes_[i]);
      for (int bit = 0; bit < 8; ++bit)
        check = static_cast<std::uint16_t>((check >> 1) ^ ((check & 1) != 0 ? 0xA001 : 0));
    }
    put(static_cast<std::uint8_t>(check & 0xFF));
    put(static_cast<std::uint8_t>(check >> 8));
    return *this;
  }
  void put(std::uint8_t byte) noexcept { bytes_[size_++] = byte; }
  void put16(std::uint16_t word) noexcept {
    put(static_cast<std::uint8_t>(word >> 8));
    put(static_cast<std::uint8_t>(word & 0xFF));
  }

  std::uint8_t bytes_[64];  // for at most 16 registers
  std::size_t size_ = 0;
};

}  // namespace chimera::library
