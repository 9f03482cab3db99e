// SPDX-License-Identifier: Apache-2.0
// Connects, accepts, reads and writes Unix stream sockets, and asks who is at the other end.
#include "chimera/platform/local_socket.h"

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

/// False with errno when the path is too long.
bool set_path(sockaddr_un& address, const std::string& path) noexcept {
  address.sun_family = AF_UNIX;
  errno = ENAMETOOLONG;
  if (path.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  return true;
}

bool connect_socket(int socket, const sockaddr_un& address) noexcept {
  return ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

bool connect_until(int socket, const sockaddr_un& address, Nanoseconds until) noexcept {
  LinuxClock clock;
  for (;;) {
    const std::int64_t left_us = std::max<std::int64_t>((until - clock.now()).count / 1000, 1);
    const timeval limit{left_us / 1'000'000, left_us % 1'000'000};
    if (::setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit) != 0) return false;
    if (connect_socket(socket, address)) return true;
    if (errno != EINTR || clock.now() >= until) return false;
  }
}

}  // namespace

OwnedDescriptor connect_to_path(const std::string& path, Nanoseconds limit) {
  sockaddr_un address{};
  if (!set_path(address, path)) return OwnedDescriptor();
  OwnedDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (socket.fd < 0 || connect_until(socket.fd, address, LinuxClock().now() + limit)) return socket;
  const int why = errno;
  socket = OwnedDescriptor();
  errno = why;
  return socket;
}

bool is_listened_at(const std::string& path) {
  sockaddr_un address{};
  if (!set_path(address, path)) return false;
  const OwnedDescriptor asking(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  return connect_socket(asking.fd, address) || errno == EAGAIN;
}

bool are_one_file(const std::string& a, const std::string& b) {
  struct stat of_a {};
  struct stat of_b {};
  return ::stat(a.c_str(), &of_a) == 0 && ::stat(b.c_str(), &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

OwnedDescriptor accept_now(int listening) noexcept {
  return OwnedDescriptor(::accept4(listening, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

std::int64_t receive_now(int socket, std::span<char> to) noexcept {
  return ::recv(socket, to.data(), to.size(), MSG_DONTWAIT);
}

std::int64_t send_now(int socket, std::string_view bytes) noexcept {
  return ::send(socket, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

int unread_by_other_end(int socket) noexcept {
  int unread = 0;
  return ::ioctl(socket, SIOCOUTQ, &unread) == 0 ? unread : -1;
}

std::optional<SocketPeer> peer_of(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  std::vector<gid_t> groups(64);
  socklen_t bytes = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) {
    groups.resize(bytes / sizeof(gid_t));  // says how many there are
    if (::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) bytes = 0;
  }
  groups.resize(bytes / sizeof(gid_t));
  groups.push_back(peer.gid);
  return SocketPeer{peer.pid, peer.uid, std::move(groups)};
}

}  // namespace chimera
