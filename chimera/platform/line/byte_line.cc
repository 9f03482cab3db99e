// SPDX-License-Identifier: Apache-2.0
// Opens a serial device or a UDP socket; every call returns at once.
#include "chimera/platform/line/byte_line.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <utility>

namespace chimera {
namespace {

constexpr std::pair<std::uint32_t, speed_t> kSpeeds[] = {
    {9600, B9600},     {19200, B19200},   {38400, B38400},   {57600, B57600},     {115200, B115200},
    {230400, B230400}, {460800, B460800}, {921600, B921600}, {1000000, B1000000}, {2000000, B2000000}};

bool waits(ssize_t result) noexcept {
  // The next call reports a datagram without receiver; the socket stays good.
  return result < 0 && (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED || errno == ENETUNREACH ||
                        errno == EHOSTUNREACH || errno == ENOBUFS);
}

bool read_port(std::string_view text, std::uint16_t& port) noexcept {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc{} && end == text.data() + text.size() && port != 0;
}

Error no_address(const std::string& address) {
  return {ErrorCode::kBadInput, {"'" + address + "' is no address; write IPV4:PORT, or IPV4:PORT@LOCAL_PORT"}, {}};
}

}  // namespace

Result<ByteLine> ByteLine::open_serial(const std::string& path, std::uint32_t baud) {
  const auto speed = std::ranges::find(kSpeeds, baud, &std::pair<std::uint32_t, speed_t>::first);
  if (speed == std::end(kSpeeds))
    return Error{ErrorCode::kBadInput, {std::to_string(baud) + " baud: Linux does not know this speed"}, {}};
  ByteLine line;
  line.file_ = OwnedDescriptor(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (!line.is_open()) return system_error(Message(path.c_str()), "open");
  termios mode{};
  if (::tcgetattr(line.file_.fd, &mode) != 0) return system_error(Message(path.c_str()), "tcgetattr");
  ::cfmakeraw(&mode);
  mode.c_cflag |= CLOCAL | CREAD;
  mode.c_cc[VMIN] = 1;  // a read without bytes then fails with EAGAIN, and 0 means the end
  mode.c_cc[VTIME] = 0;
  ::cfsetspeed(&mode, speed->second);
  if (::tcsetattr(line.file_.fd, TCSANOW, &mode) != 0) return system_error(Message(path.c_str()), "tcsetattr");
  (void)::tcflush(line.file_.fd, TCIOFLUSH);
  return line;
}

Result<ByteLine> ByteLine::open_udp(const std::string& address) {
  const std::size_t colon = address.find(':'), at = std::min(address.find('@'), address.size());
  if (colon == std::string::npos || at < colon) return no_address(address);
  sockaddr_in there{}, here{};
  there.sin_family = here.sin_family = AF_INET;
  std::uint16_t port = 0, local = 0;
  const std::string_view text(address);
  if (::inet_pton(AF_INET, address.substr(0, colon).c_str(), &there.sin_addr) != 1 ||
      !read_port(text.substr(colon + 1, at - colon - 1), port) ||
      (at < address.size() && !read_port(text.substr(at + 1), local)))
    return no_address(address);
  there.sin_port = htons(port);
  here.sin_port = htons(local);
  ByteLine line;
  line.is_datagram_ = true;
  line.file_ = OwnedDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!line.is_open()) return system_error(Message(address.c_str()), "socket");
  if (local != 0 && ::bind(line.file_.fd, reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0)
    return system_error(Message(address.c_str()), "bind");
  if (::connect(line.file_.fd, reinterpret_cast<const sockaddr*>(&there), sizeof there) != 0)
    return system_error(Message(address.c_str()), "connect");
  return line;
}

std::size_t ByteLine::read(std::span<std::byte> to) noexcept {
  if (!is_open()) return 0;
  const ssize_t got = ::read(file_.fd, to.data(), to.size());
  if (got > 0) return static_cast<std::size_t>(got);
  if (!waits(got) && !is_datagram_) close();
  return 0;
}

std::size_t ByteLine::write(std::span<const std::byte> bytes) noexcept {
  if (!is_open()) return 0;
  const ssize_t put = ::write(file_.fd, bytes.data(), bytes.size());
  if (put > 0) return static_cast<std::size_t>(put);
  if (!waits(put) && !is_datagram_) close();
  return 0;
}

}  // namespace chimera
