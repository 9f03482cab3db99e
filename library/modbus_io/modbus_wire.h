// SPDX-License-Identifier: Apache-2.0
// The bytes to and from a Modbus device: a TCP connection or a serial line. Tests have a wire of their own.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace chimera::library {

/// Calls may wait, so no cycle makes one. They return an error number as a negative one.
class ModbusWire {
 public:
  /// Returns 0 or an error.
  virtual int open() noexcept = 0;
  virtual void close() noexcept = 0;
  virtual bool is_open() const noexcept = 0;
  /// Waits at most `ms` for bytes. Returns their number, 0 if none came, or an error.
  virtual int read(std::span<std::uint8_t> to, int ms) noexcept = 0;
  /// Returns 0 or an error.
  virtual int write(std::span<const std::uint8_t> bytes) noexcept = 0;
  virtual std::int64_t now_ms() const noexcept = 0;

 protected:
  ~ModbusWire() = default;
};

class DeviceWire final : public ModbusWire {
 public:
  DeviceWire() = default;
  DeviceWire(const DeviceWire&) = delete;
  DeviceWire& operator=(const DeviceWire&) = delete;
  ~DeviceWire() { close(); }

  /// "tcp:ADDRESS:PORT" or "rtu:PATH". Throws std::runtime_error if `device` is another text, or a serial line has no
  /// such `baud`. Does not open.
  void plan(std::string device, int baud);
  bool is_tcp() const noexcept { return device_.starts_with("tcp:"); }
  /// Closes a second connection first: a device that serves one at a time would wait for its requests. Waits at most
  /// 0.2 s.
  int open() noexcept override;
  void close() noexcept override;
  bool is_open() const noexcept override { return file_ >= 0; }
  int read(std::span<std::uint8_t> to, int ms) noexcept override;
  int write(std::span<const std::uint8_t> bytes) noexcept override;
  std::int64_t now_ms() const noexcept override;

  /// Opens a second TCP connection, over which the guard writes after the death of this process; the first connection
  /// may end within a request. For a serial line returns the descriptor of that line. Returns -1 if the device refuses.
  /// Valid while has_second(). Waits at most 0.2 s.
  int open_second() noexcept;
  bool has_second() const noexcept { return has_second_; }

 private:
  int open_serial() const noexcept;
  int open_tcp() const noexcept;
  void close_second() noexcept;

  std::string device_;
  int baud_ = 19200;
  int file_ = -1, second_ = -1;
  bool has_second_ = false;
};

}  // namespace chimera::library
