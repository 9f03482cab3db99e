// SPDX-License-Identifier: Apache-2.0
// Watches descriptors by epoll.
#include "chimera/platform/descriptor_set.h"

#include <sys/epoll.h>

#include <algorithm>

namespace chimera {
namespace {

bool control(int epoll, int operation, int descriptor, std::uint32_t wanted, std::uint64_t number) noexcept {
  epoll_event event{};
  event.events = ((wanted & kToRead) != 0 ? EPOLLIN : 0u) | ((wanted & kToWrite) != 0 ? EPOLLOUT : 0u);
  event.data.u64 = number;
  return ::epoll_ctl(epoll, operation, descriptor, &event) == 0;
}

}  // namespace

Result<DescriptorSet> DescriptorSet::open(const Message& what) noexcept {
  OwnedDescriptor epoll(::epoll_create1(EPOLL_CLOEXEC));
  if (epoll.fd < 0) return system_error(what, "epoll");
  return DescriptorSet(std::move(epoll));
}

bool DescriptorSet::add(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept {
  return control(epoll_.fd, EPOLL_CTL_ADD, descriptor, wanted, number);
}

bool DescriptorSet::change(int descriptor, std::uint32_t wanted, std::uint64_t number) const noexcept {
  return control(epoll_.fd, EPOLL_CTL_MOD, descriptor, wanted, number);
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

}  // namespace chimera
