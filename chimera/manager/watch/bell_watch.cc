// SPDX-License-Identifier: Apache-2.0
// A thread that waits on a doorbell and rings an event for it.
#include "chimera/manager/watch/bell_watch.h"

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "chimera/platform/descriptor.h"

namespace chimera::manager {

Result<std::unique_ptr<BellWatch>> BellWatch::start(Doorbell bell) {
  auto event = WakeEvent::open(Message("watch of the bell"));
  if (!event) return event.error();
  std::unique_ptr<BellWatch> made(new BellWatch(bell, *std::move(event)));
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
}

void BellWatch::watch() noexcept {
  std::uint32_t seen = bell_.read() - 1;  // the first wait returns at once: an earlier ring counts
  while (!stop_) {
    bell_.wait_until(seen, kNever);
    const std::uint32_t now = bell_.read();
    if (now == seen) continue;
    seen = now;
    event_.ring();
  }
}

}  // namespace chimera::manager
