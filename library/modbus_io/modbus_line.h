// SPDX-License-Identifier: Apache-2.0
// One Modbus device as its client sees it, behind a face without libmodbus. Every call may wait for the device; none is
// made in a cycle.
#pragma once

#include <array>
#include <cstdint>
#include <string>

struct _modbus;

namespace chimera::library {

inline constexpr std::size_t kMostPoints = 12;  // of each kind: a component has 64 ports

/// Where a device is and what of it is used.
struct ModbusPlan {
  std::string device;  // "tcp:ADDRESS:PORT" or "rtu:PATH"
  int unit = 1;
  int baud = 19200;    // rtu; 8 bits, even parity
  int first_input = 0, inputs = 0;
  int first_contact = 0, contacts = 0;
  int first_holding = 0, holdings = 0;
  int first_coil = 0, coils = 0;
};

struct ModbusReading {
  std::array<std::uint16_t, kMostPoints> inputs{};
  std::array<std::uint8_t, kMostPoints> contacts{};
  std::uint64_t exchange = 0;  // number of the exchange that brought it; 0: none yet
};

struct ModbusCommand {
  std::array<std::uint16_t, kMostPoints> holdings{};
  std::array<std::uint8_t, kMostPoints> coils{};
  bool is_given = false;  // false: nothing is written
};

class ModbusLine {
 public:
  ModbusLine() = default;
  ModbusLine(const ModbusLine&) = delete;
  ModbusLine& operator=(const ModbusLine&) = delete;
  ~ModbusLine() { close(); }

  /// Throws std::runtime_error for a plan that names no device. Does not connect.
  void plan(const ModbusPlan& plan);
  /// 0, or the error number. Waits 0.2 s at most.
  int connect() noexcept;
  /// Writes, then reads, four requests at most; 0, or the error number of the first that failed, 0.2 s each; then
  /// the line is to be connected again.
  int exchange(const ModbusCommand& command, ModbusReading& reading) noexcept;
  void close() noexcept;

  /// What libmodbus says of an error number.
  static const char* text_of(int error) noexcept;

 private:
  ModbusPlan plan_;
  _modbus* context_ = nullptr;
};

}  // namespace chimera::library
