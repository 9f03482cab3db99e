// SPDX-License-Identifier: Apache-2.0
// Opens a Modbus device by TCP or on a serial line, and moves bytes with a limit of time.
#include "library/modbus_io/modbus_wire.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "library/device/net_address.h"

namespace chimera::library {
namespace {

constexpr int kConnectMs = 200;

/// B0 for a number of bits a second that no serial line has.
speed_t speed_of(int baud) noexcept {
  constexpr std::pair<int, speed_t> kSpeeds[] = {{1200, B1200},   {2400, B2400},   {4800, B4800},   {9600, B9600},
                                                 {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}};
  for (const auto& [rate, speed] : kSpeeds)
    if (rate == baud) return speed;
  return B0;
}

/// Closes `file`. Returns `error` as a result of ModbusWire.
int refuse(int file, int error) noexcept {
  ::close(file);
  return -error;
}

}  // namespace

void DeviceWire::plan(std::string device, int baud) {
  close();
  device_ = std::move(device);
  baud_ = baud;
  const bool is_rtu = device_.starts_with("rtu:/");
  if (!is_rtu && !(is_tcp() && net_address(device_.substr(4)).sin_port != 0))
    throw std::runtime_error("\"" + device_ +
                             "\" is no Modbus device: \"tcp:192.168.0.7:502\" and \"rtu:/dev/ttyS0\" are");
  if (is_rtu && speed_of(baud) == B0)
    throw std::runtime_error("`baud` is one of 1200 2400 4800 9600 19200 38400 57600 115200");
}

int DeviceWire::open() noexcept {
  close();
  const int opened = is_tcp() ? open_tcp() : open_serial();
  if (opened < 0) return opened;
  file_ = opened;
  return 0;
}

void DeviceWire::close() noexcept {
  close_second();
  if (file_ >= 0) ::close(std::exchange(file_, -1));
}

int DeviceWire::open_serial() const noexcept {
  const int file = ::open(device_.c_str() + 4, O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (file < 0) return -errno;
  termios mode{};
  if (::tcgetattr(file, &mode) != 0) return refuse(file, errno);
  ::cfmakeraw(&mode);
  mode.c_cflag |= CLOCAL | CREAD | PARENB;
  mode.c_cc[VMIN] = 1;  // a read without bytes then fails with EAGAIN, and 0 means the end
  mode.c_cc[VTIME] = 0;
  ::cfsetspeed(&mode, speed_of(baud_));
  // A pseudo terminal has no parity, and refuses a mode that differs from its own in nothing else.
  if (::tcsetattr(file, TCSANOW, &mode) != 0 && errno != EINVAL) return refuse(file, errno);
  return file;
}

int DeviceWire::open_tcp() const noexcept {
  const sockaddr_in to = net_address(device_.substr(4));
  const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (file < 0) return -errno;
  int error = ::connect(file, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ? 0 : errno;
  if (error == EINPROGRESS) {
    pollfd ready{file, POLLOUT, 0};
    socklen_t size = sizeof error;
    error = ETIMEDOUT;
    if (::poll(&ready, 1, kConnectMs) > 0) ::getsockopt(file, SOL_SOCKET, SO_ERROR, &error, &size);
  }
  if (error != 0) return refuse(file, error);
  const int at_once = 1;
  ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  return file;
}

int DeviceWire::read(std::span<std::uint8_t> to, int ms) noexcept {
  pollfd ready{file_, POLLIN, 0};
  if (::poll(&ready, 1, ms) <= 0) return 0;
  const ssize_t got = ::read(file_, to.data(), to.size());
  if (got == 0) return -ECONNRESET;
  return got > 0 ? static_cast<int>(got) : errno == EAGAIN || errno == EINTR ? 0 : -errno;
}

int DeviceWire::write(std::span<const std::uint8_t> bytes) noexcept {
  const ssize_t put = is_tcp() ? ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                               : ::write(file_, bytes.data(), bytes.size());
  if (put == static_cast<ssize_t>(bytes.size())) return 0;
  return put < 0 && errno != EAGAIN ? -errno : -ETIMEDOUT;
}

std::int64_t DeviceWire::now_ms() const noexcept {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::milliseconds(1);
}

int DeviceWire::open_second() noexcept {
  close_second();
  if (is_tcp()) second_ = open_tcp();
  has_second_ = is_tcp() ? second_ >= 0 : file_ >= 0;
  return is_tcp() ? (second_ < 0 ? -1 : second_) : file_;
}

void DeviceWire::close_second() noexcept {
  has_second_ = false;
  if (second_ >= 0) ::close(second_);
  second_ = -1;
}

}  // namespace chimera::library
