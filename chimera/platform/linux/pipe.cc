// SPDX-License-Identifier: Apache-2.0
// Makes pipes, and reads a line from one with a limit of time.
#include "chimera/platform/pipe.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace chimera {

Result<Pipe> Pipe::open() noexcept {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return (Message() << std::strerror(errno)).error(ErrorCode::kSystem);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return Pipe{OwnedDescriptor(ends[0]), OwnedDescriptor(ends[1])};
}

std::string Pipe::first_line(Nanoseconds patience) const {
  std::string text;
  pollfd wait{reading.fd, POLLIN, 0};
  for (auto left = static_cast<int>(patience.count / 1'000'000); left > 0; left -= 20) {
    char byte = 0;
    if (::poll(&wait, 1, 20) <= 0) continue;
    while (::read(reading.fd, &byte, 1) == 1) {
      if (byte == '\n') return text;
      if (text.size() < 200) text += byte;
    }
    if ((wait.revents & POLLHUP) != 0) return {};
  }
  return {};
}

}  // namespace chimera
