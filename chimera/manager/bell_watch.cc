// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/bell_watch.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "chimera/base/assert.h"

namespace chimera::manager {

BellWatch::BellWatch(Doorbell bell) : bell_(bell), descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  CHIMERA_ASSERT(descriptor_ >= 0);
  thread_ = std::thread([this] { watch(); });
}

BellWatch::~BellWatch() {
  stop_ = true;
  bell_.ring();
  thread_.join();
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
