// SPDX-License-Identifier: Apache-2.0
// Exchanges datagrams with one peer. No call waits.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "library/device/net_address.h"

namespace chimera::library {

class UdpSocket {
 public:
  UdpSocket() = default;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  ~UdpSocket() { close(); }

  /// Opens a socket for `peer`, "ADDRESS:PORT" in numbers; `local_port` 0: any. Datagrams of other senders are not
  /// received. Throws std::runtime_error with a remedy. Context: setup; no name lookup, no wait.
  void open(const std::string& peer, int local_port) {
    close();
    (void)address_of(peer);
    file_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (file_ < 0) refuse(peer, "");
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(static_cast<std::uint16_t>(local_port));
    if (::bind(file_, reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0)
      refuse("UDP port " + std::to_string(local_port), ": name another `local_port`, or end the process that has it");
    connect(peer);
  }
  /// Changes the peer and keeps the port: a copy of the descriptor, such as the guard's, would prevent binding the port
  /// again. Requires: the socket is open, and remains open. Throws as open(). Context: setup; no wait.
  void connect(const std::string& peer) {
    const sockaddr_in there = address_of(peer);
    if (::connect(file_, reinterpret_cast<const sockaddr*>(&there), sizeof there) != 0)
      throw std::runtime_error(peer + ": " + std::strerror(errno) +
                               ": there is no way to that address; see `ip route get`");
  }
  void close() noexcept {
    if (file_ >= 0) ::close(std::exchange(file_, -1));
  }
  /// Returns the size of one datagram, which may be 0; nullopt: none waits. Context: cycle; one system call that does
  /// not wait, one more if the network reports an error before.
  std::optional<std::size_t> receive(std::span<std::uint8_t> to) noexcept {
    ssize_t got = ::recv(file_, to.data(), to.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (got < 0 && errno != EAGAIN) {
      error_ = errno;
      got = ::recv(file_, to.data(), to.size(), MSG_DONTWAIT | MSG_TRUNC);
    }
    if (got < 0) return std::nullopt;
    error_ = 0;
    return static_cast<std::size_t>(got);
  }
  /// Returns false if the datagram was not sent. Context: cycle; one system call that does not wait.
  bool send(std::span<const std::uint8_t> from) noexcept {
    const ssize_t put = ::send(file_, from.data(), from.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    error_ = put < 0 ? errno : error_;
    return put == static_cast<ssize_t>(from.size());
  }
  /// Below 0 if it is not open. Context: any; wait-free.
  int descriptor() const noexcept { return file_; }
  /// Error number of the last failure after the last datagram (111: the peer has no such port open); 0: none.
  int error() const noexcept { return error_; }

 private:
  static sockaddr_in address_of(const std::string& peer) {
    const sockaddr_in made = net_address(peer);
    if (made.sin_port == 0) throw std::runtime_error("\"" + peer + "\" is no address: \"192.168.0.7:5000\" is one");
    return made;
  }
  [[noreturn]] void refuse(const std::string& what, const char* remedy) {
    const int error = errno;
    close();
    throw std::runtime_error(what + ": " + std::strerror(error) + remedy);
  }

  int file_ = -1;
  int error_ = 0;
};

}  // namespace chimera::library
