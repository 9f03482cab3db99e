// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/session.h"

#include <sys/socket.h>

#include <cerrno>

namespace chimera::control {

void Session::receive() {
  char bytes[1 << 16];
  while (input_.size() <= kMaxLine) {
    const ssize_t got = ::recv(socket_.fd, bytes, sizeof bytes, MSG_DONTWAIT);
    if (got > 0) {
      input_.append(bytes, static_cast<std::size_t>(got));
      continue;
    }
    has_ended_ = got == 0 || (errno != EAGAIN && errno != EINTR);
    return;
  }
}

bool Session::take_line(std::string& line) {
  const std::size_t end = input_.find('\n');
  if (end == std::string::npos && input_.size() <= kMaxLine) return false;
  const std::size_t length = end == std::string::npos ? input_.size() : end;
  line = input_.substr(0, length);
  input_.erase(0, end == std::string::npos ? length : length + 1);
  return true;
}

bool Session::flush(Nanoseconds now) {
  while (has_output()) {
    const ssize_t sent =
        ::send(socket_.fd, output_.data() + sent_, output_.size() - sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) return false;
    if (sent < 0) return now - moved_ < kPatience;
    sent_ += static_cast<std::size_t>(sent);
    moved_ = now;
  }
  output_.clear();
  sent_ = 0;
  moved_ = now;
  return !is_closing_;
}

}  // namespace chimera::control
