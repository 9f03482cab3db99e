// SPDX-License-Identifier: Apache-2.0
// Sends messages with descriptors over a pair of Unix sockets; connects, accepts, reads and writes stream sockets.
#include "chimera/platform/local_socket.h"

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "chimera/platform/clock.h"

namespace chimera {
namespace {

// Room for one descriptor, with the alignment that the kernel expects.
union Control {
  cmsghdr head;
  char bytes[CMSG_SPACE(sizeof(int))];
};

// Returns the first descriptor in `message` and closes any others.
int passed_in(msghdr& message) noexcept {
  int first = -1;
  for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr; head = CMSG_NXTHDR(&message, head)) {
    if (head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t n = (head->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < n; ++i) {
      int fd = -1;
      std::memcpy(&fd, CMSG_DATA(head) + i * sizeof(int), sizeof fd);
      if (first < 0)
        first = fd;
      else
        ::close(fd);
    }
  }
  return first;
}

/// False with errno when the path is too long.
bool set_path(sockaddr_un& address, const std::string& path) noexcept {
  address.sun_family = AF_UNIX;
  errno = ENAMETOOLONG;
  if (path.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  return true;
}

OwnedDescriptor make_socket() noexcept {
  return OwnedDescriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

/// The address of a name of claim_name(), which is cut to its room.
struct AbstractAddress {
  explicit AbstractAddress(std::string_view name) noexcept {
    const std::size_t bytes = std::min(name.size(), sizeof un.sun_path - 1);
    un.sun_family = AF_UNIX;
    std::memcpy(un.sun_path + 1, name.data(), bytes);  // a zero before the name: abstract
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + bytes);
  }
  const sockaddr* get() const noexcept { return reinterpret_cast<const sockaddr*>(&un); }
  sockaddr_un un{};
  socklen_t size = 0;
};

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

Result<std::pair<Channel, Channel>> Channel::pair() noexcept {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return system_error(Message("channel between two processes"), "socketpair");
  return std::pair(Channel(ends[0]), Channel(ends[1]));
}

bool Channel::send(std::span<const std::byte> bytes, int passed) const noexcept {
  iovec part{const_cast<std::byte*>(bytes.data()), bytes.size()};
  Control control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (passed >= 0) {
    message.msg_control = &control;
    message.msg_controllen = sizeof control;
    control.head.cmsg_level = SOL_SOCKET;
    control.head.cmsg_type = SCM_RIGHTS;
    control.head.cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(&control.head), &passed, sizeof passed);
  }
  ssize_t sent;
  do sent = ::sendmsg(descriptor(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(bytes.size());
}

Channel::Got Channel::receive(std::span<std::byte> bytes, int& passed) const noexcept {
  passed = -1;
  iovec part{bytes.data(), bytes.size()};
  Control control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = &control;
  message.msg_controllen = sizeof control;
  ssize_t got;
  // ECONNRESET: the other end died with unread messages. The kernel reports this once, before the messages it sent.
  do got = ::recvmsg(descriptor(), &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  while (got < 0 && (errno == EINTR || errno == ECONNRESET));
  if (got < 0) return errno == EAGAIN ? Got::kNothing : Got::kClosed;
  passed = passed_in(message);
  if (passed < 0 && (message.msg_flags & MSG_CTRUNC) != 0) passed = kLostDescriptor;
  if (static_cast<std::size_t>(got) == bytes.size() && (message.msg_flags & MSG_TRUNC) == 0) return Got::kMessage;
  if (passed >= 0) ::close(std::exchange(passed, -1));
  return Got::kClosed;
}

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
  const OwnedDescriptor asking = make_socket();
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

OwnedDescriptor claim_name(std::string_view name) noexcept {
  OwnedDescriptor claim = make_socket();
  const AbstractAddress address(name);
  if (claim.fd >= 0 && ::bind(claim.fd, address.get(), address.size) == 0 && ::listen(claim.fd, 64) == 0) return claim;
  const int why = errno;
  claim = OwnedDescriptor();
  errno = why;
  return claim;
}

NameHolder holder_of_name(std::string_view name) noexcept {
  const OwnedDescriptor asking = make_socket();
  const AbstractAddress address(name);
  ucred holder{};
  socklen_t size = sizeof holder;
  if (asking.fd < 0 || ::connect(asking.fd, address.get(), address.size) != 0 ||
      ::getsockopt(asking.fd, SOL_SOCKET, SO_PEERCRED, &holder, &size) != 0)
    return {};
  return {holder.pid, holder.uid};
}

std::optional<SocketPeer> peer_of(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  std::vector<gid_t> groups(64);
  socklen_t bytes = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) {
    groups.resize(bytes / sizeof(gid_t));  // the kernel has set the number of groups
    if (::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) bytes = 0;
  }
  groups.resize(bytes / sizeof(gid_t));
  groups.push_back(peer.gid);
  return SocketPeer{peer.pid, peer.uid, std::move(groups)};
}

}  // namespace chimera
