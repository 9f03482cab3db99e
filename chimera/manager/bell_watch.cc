// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/bell_watch.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>
#include <system_error>

#include "chimera/platform/owned_descriptor.h"

namespace chimera::manager {

Result<std::unique_ptr<BellWatch>> BellWatch::start(Doorbell bell) {
  OwnedDescriptor descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (descriptor.fd < 0) return system_error(Message("watch of the bell"), "eventfd");
  std::unique_ptr<BellWatch> made(new BellWatch(bell, descriptor.release()));
  try {
    made->thread_ = std::thread([watch = made.get()] { watch->watch(); });
  } catch (const std::system_error& error) {
    errno = error.code().value();
    return system_error(Message("watch of the bell"), "thread");
  }
  return made;
}

BellWatch::~BellWatch() {
  stop_ = true;
  bell_.ring();
  if (thread_.joinable()) thread_.join();
  ::close(descriptor_);
}

void BellWatch::watch() noexcept {
  std::uint32_t seen = bell_.read() - 1;  // the first wait returns at once: what was rung before counts
  while (!stop_) {
    bell_.wait_until(seen, kNever);
    const std::uint32_t now = bell_.read();
    if (now == seen) continue;
    seen = now;
    const std::uint64_t one = 1;
    // A full counter is readable already: nothing is lost by not adding to it.
    [[maybe_unused]] const ssize_t written = ::write(descriptor_, &one, sizeof one);
  }
}

void BellWatch::reset() const noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(descriptor_, &count, sizeof count);  // nothing to read: not rung
}

}  // namespace chimera::manager
