// SPDX-License-Identifier: Apache-2.0
// One Modbus device, behind an interface without libmodbus. Every call may wait for the device, so no cycle makes one.
#pragma once

#include <array>
#include <cstdint>
#include <string>

struct _modbus;

namespace chimera::library {

inline constexpr std::size_t kMostPoints = 12;  // of each kind, because a component has at most 64 ports

/// Address of a device, and the points to exchange.
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
  std::uint64_t exchange = 0;  // number of the exchange that read it; 0: none yet
  std::uint64_t command = 0;   // number of the command written before it; 0: none
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

  /// Throws std::runtime_error if the plan names no device. Does not connect.
  void plan(const ModbusPlan& plan);
  /// Returns 0 or an error number. Waits at most 0.2 s. Closes a second connection, because a device that serves one
  /// connection at a time would wait for its requests.
  int connect() noexcept;
  /// Writes, then reads: at most four requests of at most 0.2 s each. Returns 0 or the error number of the first that
  /// failed; the line must then be connected again.
  int exchange(const ModbusCommand& command, ModbusReading& reading) noexcept;
  /// Opens a second TCP connection, over which the guard writes after the death of this process; the first connection
  /// may end within a request. For a serial line returns the descriptor of that line. Returns -1 if the device refuses.
  /// Valid until connect(). Waits at most 0.2 s.
  int open_second() noexcept;
  bool has_second() const noexcept { return second_ != nullptr; }
  void close() noexcept;
  bool is_tcp() const noexcept { return plan_.device.starts_with("tcp:"); }

  /// Text of libmodbus for an error number.
  static const char* text_of(int error) noexcept;

 private:
  void give_up_second() noexcept;

  ModbusPlan plan_;
  _modbus* context_ = nullptr;
  _modbus* second_ = nullptr;
};

}  // namespace chimera::library
