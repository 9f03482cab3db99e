// SPDX-License-Identifier: Apache-2.0
// Closes descriptors, waits for them by ppoll and epoll, makes pipes, and writes without waiting.
#include "chimera/platform/descriptor.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

constexpr std::size_t kMostPolled = 64;
constexpr std::size_t kMostLine = 200;
constexpr int kPollSlice = 20;  // ms

// ppoll, because the limit of poll() counts milliseconds.
int poll_for(pollfd* events, std::size_t n, Nanoseconds limit) noexcept {
  const Nanoseconds left = std::max(limit, Nanoseconds{0});
  const timespec patience{left.count / 1'000'000'000, left.count % 1'000'000'000};
  return ::ppoll(events, n, limit == kNever ? nullptr : &patience, nullptr);
}

bool control_set(int epoll, int operation, int descriptor, std::uint32_t wanted, std::uint64_t number) noexcept {
  epoll_event event{};
  event.events = ((wanted & kToRead) != 0 ? EPOLLIN : 0u) | ((wanted & kToWrite) != 0 ? EPOLLOUT : 0u);
  event.data.u64 = number;
  return ::epoll_ctl(epoll, operation, descriptor, &event) == 0;
}

}  // namespace

OwnedDescriptor::~OwnedDescriptor() {
  if (fd >= 0) ::close(fd);
}

Error system_error(const Message& what, const char* call) noexcept {
  const int error = errno;
  return (Message() << what.view() << ": " << call << " failed: " << ::strerrordesc_np(error))
      .error(ErrorCode::kSystem);
}

void end_without_descriptor() noexcept {
  constexpr const char* kReason = "a component closed descriptors that are not its own: the process ends\n";
  if (::write(STDERR_FILENO, kReason, std::strlen(kReason)) < 0) ::_exit(kDescriptorLost);  // stderr may be closed too
  ::_exit(kDescriptorLost);
}

bool await_readable(std::span<const int> descriptors, Nanoseconds limit) noexcept {
  CHIMERA_ASSERT(descriptors.size() <= kMostPolled);
  pollfd events[kMostPolled];
  for (std::size_t i = 0; i < descriptors.size(); ++i) events[i] = {descriptors[i], POLLIN, 0};
  return poll_for(events, descriptors.size(), limit) > 0;
}

int await_ready(std::span<Watched> watched, Nanoseconds limit) noexcept {
  CHIMERA_ASSERT(watched.size() <= kMostPolled);
  pollfd events[kMostPolled];
  for (std::size_t i = 0; i < watched.size(); ++i)
    events[i] = {watched[i].descriptor, static_cast<short>(watched[i].for_room ? POLLOUT : POLLIN), 0};
  const int found = poll_for(events, watched.size(), limit);
  for (std::size_t i = 0; i < watched.size(); ++i) {
    watched[i].is_ready = found > 0 && events[i].revents != 0;
    watched[i].is_lost = found > 0 && (events[i].revents & POLLNVAL) != 0;
  }
  return found;
}

Result<DescriptorSet> DescriptorSet::open(const Message& what) noexcept {
  OwnedDescriptor epoll(::epoll_create1(EPOLL_CLOEXEC));
  if (epoll.fd < 0) return system_error(what, "epoll");
  return DescriptorSet(std::move(epoll));
}

bool DescriptorSet::add(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept {
  return control_set(epoll_.fd, EPOLL_CTL_ADD, descriptor, wanted, number);
}

bool DescriptorSet::change(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept {
  return control_set(epoll_.fd, EPOLL_CTL_MOD, descriptor, wanted, number);
}

std::size_t DescriptorSet::take(std::span<Ready> ready) const noexcept {
  constexpr std::size_t kMost = 256;
  epoll_event events[kMost];
  const int n = ::epoll_wait(epoll_.fd, events, static_cast<int>(std::min(ready.size(), kMost)), 0);
  for (int i = 0; i < n; ++i) {
    const std::uint64_t number = events[i].data.u64;  // a copy: the event itself is packed
    const std::uint32_t found = events[i].events;
    ready[static_cast<std::size_t>(i)] = {number, (found & (EPOLLIN | EPOLLHUP | EPOLLERR)) != 0,
                                          (found & (EPOLLHUP | EPOLLERR)) != 0};
  }
  return n < 0 ? 0 : static_cast<std::size_t>(n);
}

Result<Pipe> Pipe::open() noexcept {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return (Message() << std::strerror(errno)).error(ErrorCode::kSystem);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return Pipe{OwnedDescriptor(ends[0]), OwnedDescriptor(ends[1])};
}

std::string Pipe::first_line(Nanoseconds patience) const {
  std::string text;
  pollfd wait{reading.fd, POLLIN, 0};
  for (auto left = static_cast<int>(patience.count / 1'000'000); left > 0; left -= kPollSlice) {
    char byte = 0;
    if (::poll(&wait, 1, kPollSlice) <= 0) continue;
    while (::read(reading.fd, &byte, 1) == 1) {
      if (byte == '\n') return text;
      if (text.size() < kMostLine) text += byte;
    }
    if ((wait.revents & POLLHUP) != 0) return {};
  }
  return {};
}

void take_over_device(int descriptor) noexcept {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags >= 0 && (flags & O_NONBLOCK) == 0) (void)::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
  (void)::tcflush(descriptor, TCOFLUSH);  // fails on a device that is no terminal: such a device has nothing to drop
}

int write_device(int descriptor, std::span<const std::byte> bytes) noexcept {
  const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
  if (put >= 0) return static_cast<int>(put);
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

}  // namespace chimera
