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
  std::uint64_t command = 0;   // number of the command that was written before it; 0: none
};

struct ModbusCommand {
  std::array<std::uint16_t, kMostPoints> holdings{};
  std::array<std::uint8_t, kMostPoints> coils{};
  std::uint64_t number = 0;  // 0: nothing is written
};

class ModbusLine {
 public:
  ModbusLine() = default;
  ModbusLine(const ModbusLine&) = delete;
  ModbusLine& operator=(const ModbusLine&) = delete;
  ~ModbusLine() { close(); }

  /// Throws std::runtime_error for a plan that names no device. Does not connect.
  void plan(const ModbusPlan& plan);
  /// 0, or the error number. Waits 0.2 s at most. Gives up a second connection: a device that serves one at a time
  /// would wait for it to speak.
  int connect() noexcept;
  /// Writes, then reads, four requests at most; 0, or the error number of the first that failed, 0.2 s each; then
  /// the line is to be connected again.
  int exchange(const ModbusCommand& command, ModbusReading& reading) noexcept;
  /// A second connection to a device behind TCP, for whoever writes when this process is dead: the first one may end in
  /// the middle of a request. Of a serial line the same line. -1: the device takes no second one. Good until connect().
  /// Waits 0.2 s at most.
  int open_second() noexcept;
  bool has_second() const noexcept { return second_ != nullptr; }
  void close() noexcept;
  bool is_tcp() const noexcept { return plan_.device.starts_with("tcp:"); }

  /// What libmodbus says of an error number.
  static const char* text_of(int error) noexcept;

 private:
  void give_up_second() noexcept;

  ModbusPlan plan_;
  _modbus* context_ = nullptr;
  _modbus* second_ = nullptr;
};

}  // namespace chimera::library
