// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/control_line.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "chimera/platform/linux/linux_clock.h"

namespace chimera::desk {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestLine = 64u << 20;  // of an answer; a request is much shorter
constexpr Nanoseconds kTryAgain = milliseconds(10);

Nanoseconds now() noexcept { return LinuxClock().now(); }

Error refusal_of(const Json& error) {
  Error made{ErrorCode::kRefused, std::string_view(error.value("message", "?")), {}};
  if (const auto data = error.find("data"); data != error.end() && data->is_object())
    made.where.assign(data->value("where", ""));
  return made;
}

}  // namespace

bool ControlLine::connect() {
  if (is_connected()) return true;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path_.c_str(), path_.size());
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  heard_.clear();
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) hang_up();
  return is_connected();
}

void ControlLine::hang_up() noexcept {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
}

bool ControlLine::send(const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t n = ::send(socket_, line.data() + done, line.size() - done, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      hang_up();
      return false;
    }
    done += static_cast<std::size_t>(n);
  }
  return true;
}

/// The next whole line as JSON. What is none loses the connection.
std::optional<Json> ControlLine::line(Nanoseconds instant) {
  while (is_connected()) {
    if (const std::size_t end = heard_.find('\n'); end != std::string::npos) {
      Json json = Json::parse(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
      heard_.erase(0, end + 1);
      if (json.is_object()) return json;
      hang_up();
      return std::nullopt;
    }
    const Nanoseconds left = std::max(instant - now(), Nanoseconds{0});
    const timespec patience{left.count / 1'000'000'000, left.count % 1'000'000'000};
    pollfd event{socket_, POLLIN, 0};
    if (::ppoll(&event, 1, &patience, nullptr) <= 0) return std::nullopt;
    char bytes[65536];
    const ssize_t n = ::recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT);
    if (n > 0) heard_.append(bytes, static_cast<std::size_t>(n));
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR) || heard_.size() > kLongestLine) hang_up();
  }
  return std::nullopt;
}

Result<Json> ControlLine::ask(const std::string& method, const Json& parameters, Nanoseconds patience) {
  const Nanoseconds until = now() + patience;
  do {
    const int id = ++last_id_;
    const Json request = {{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", parameters}};
    if (connect() && send(request.dump() + "\n")) {
      while (is_connected() && now() < until) {
        auto heard = line(until);
        if (!heard || heard->value("id", Json()) != id) continue;  // a notification, or a signal came
        if (const auto error = heard->find("error"); error != heard->end()) return refusal_of(*error);
        return heard->value("result", Json::object());
      }
    }
    if (!is_connected()) LinuxClock().wait_until(now() + kTryAgain);
  } while (now() < until);
  return Error{ErrorCode::kSystem, std::string_view("the manager of the subsystem does not answer"),
               std::string_view(path_)};
}

std::optional<Json> ControlLine::notification(Nanoseconds instant) {
  auto heard = line(instant);
  if (!heard || heard->contains("id")) return std::nullopt;
  return heard->value("params", Json::object());
}

}  // namespace chimera::desk
