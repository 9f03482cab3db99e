// SPDX-License-Identifier: Apache-2.0
// A serial device whose calls never wait.
#pragma once

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "library/device/sentence.h"

namespace chimera::library {

class SerialPort {
 public:
  SerialPort() = default;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  ~SerialPort() { close(); }

  /// Eight bits, no parity, no flow control, no translation. Throws std::runtime_error with path and remedy.
  /// Context: setup; may block.
  void open(const std::string& path, int baud) {
    close();
    const speed_t speed = speed_of(baud);
    file_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file_ < 0) throw std::runtime_error(open_refusal(path, errno));
    termios mode{};
    if (::tcgetattr(file_, &mode) != 0) {
      close();
      throw std::runtime_error(path + ": no serial device: those are /dev/ttyS*, /dev/ttyUSB*, /dev/ttyACM*");
    }
    ::cfmakeraw(&mode);
    mode.c_cflag |= CLOCAL | CREAD;
    mode.c_cc[VMIN] = 1;  // a read without bytes then fails with EAGAIN, and 0 means the end
    mode.c_cc[VTIME] = 0;
    ::cfsetspeed(&mode, speed);
    if (::tcsetattr(file_, TCSANOW, &mode) == 0) return;
    const int error = errno;
    close();
    throw std::runtime_error(open_refusal(path, error));
  }
  void close() noexcept {
    if (file_ >= 0) ::close(std::exchange(file_, -1));
  }
  /// Drops received bytes. Context: cycle boundary; wait-free, one system call.
  void flush() noexcept { ::tcflush(file_, TCIFLUSH); }
  /// Returns the number of bytes read into `to`; -1: the device is gone. Context: cycle; one system call that does not
  /// wait.
  int read(std::span<std::uint8_t> to) noexcept {
    const ssize_t got = ::read(file_, to.data(), to.size());
    return got > 0 ? static_cast<int>(got) : waits(got) ? 0 : -1;
  }
  /// Returns the number of bytes written; -1: the device is gone. Context: cycle; one system call that does not wait.
  int write(std::span<const std::uint8_t> from) noexcept {
    const ssize_t put = ::write(file_, from.data(), from.size());
    return put > 0 ? static_cast<int>(put) : waits(put) ? 0 : -1;
  }
  /// Below 0 if it is not open. Context: any; wait-free.
  int descriptor() const noexcept { return file_; }
  /// Error number of the last failure; 0: the device hung up.
  int error() const noexcept { return error_; }

 private:
  bool waits(ssize_t result) noexcept {
    error_ = result < 0 ? errno : 0;
    return result < 0 && (errno == EAGAIN || errno == EINTR);
  }
  static speed_t speed_of(int baud) {
    constexpr std::pair<int, speed_t> kSpeeds[] = {
        {9600, B9600},     {19200, B19200},   {38400, B38400},   {57600, B57600},    {115200, B115200},
        {230400, B230400}, {460800, B460800}, {921600, B921600}, {1000000, B1000000}, {2000000, B2000000}};
    std::string known;
    for (const auto& [rate, speed] : kSpeeds) {
      if (rate == baud) return speed;
      known += " " + std::to_string(rate);
    }
    throw std::runtime_error("`baud` is one of" + known);
  }

  int file_ = -1;
  int error_ = 0;
};

}  // namespace chimera::library
