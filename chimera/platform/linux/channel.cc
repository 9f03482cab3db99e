// SPDX-License-Identifier: Apache-2.0
// Sends and receives messages with descriptors over a pair of Unix sockets.
#include "chimera/platform/channel.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "chimera/platform/owned_descriptor.h"

namespace chimera {
namespace {

// Room for one descriptor, aligned as the kernel wants it.
union Control {
  cmsghdr head;
  char bytes[CMSG_SPACE(sizeof(int))];
};

// The first descriptor in `message`; any others are closed.
int passed_in(msghdr& message) noexcept {
  int first = -1;
  for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr; head = CMSG_NXTHDR(&message, head)) {
    if (head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t n = (head->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < n; ++i) {
      int fd = -1;
      std::memcpy(&fd, CMSG_DATA(head) + i * sizeof(int), sizeof fd);
      if (first < 0) first = fd;
      else ::close(fd);
    }
  }
  return first;
}

}  // namespace

Result<std::pair<Channel, Channel>> Channel::pair() noexcept {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return system_error(Message("channel between two processes"), "socketpair");
  return std::pair(Channel(ends[0]), Channel(ends[1]));
}

Channel& Channel::operator=(Channel&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

Channel::~Channel() {
  if (descriptor_ >= 0) ::close(descriptor_);
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
  do sent = ::sendmsg(descriptor_, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
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
  // The other end died with something unread: the kernel says so once, before what it had sent itself.
  do got = ::recvmsg(descriptor_, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  while (got < 0 && (errno == EINTR || errno == ECONNRESET));
  if (got < 0) return errno == EAGAIN ? Got::kNothing : Got::kClosed;
  passed = passed_in(message);
  if (static_cast<std::size_t>(got) == bytes.size() && (message.msg_flags & MSG_TRUNC) == 0) return Got::kMessage;
  if (passed >= 0) ::close(std::exchange(passed, -1));
  return Got::kClosed;
}

}  // namespace chimera
