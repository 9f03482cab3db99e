// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/client.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "chimera/config/nearest.h"
#include "chimera/control/request.h"
#include "chimera/control/running.h"
#include "chimera/platform/linux/linux_clock.h"
#include "chimera/platform/socket_folder.h"

namespace chimera::control {
namespace {

Nanoseconds now() { return LinuxClock().now(); }

bool wait_for(int descriptor, short events, Nanoseconds until) {
  for (;;) {
    const std::int64_t left_ms = (until - now()).count / 1'000'000 + 1;
    pollfd one{descriptor, events, 0};
    const int n = ::poll(&one, 1, left_ms <= 0 ? 0 : static_cast<int>(std::min<std::int64_t>(left_ms, 60'000)));
    if (n > 0) return true;
    if ((n == 0 || errno != EINTR) && now() >= until) return false;
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Answer lost() { return Answer::error(kNoConnection, "the connection to the subsystem was lost"); }

}  // namespace

Result<Client> Client::connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return Error{ErrorCode::kBadInput, {"the path is too long"}, {path}};
  std::memcpy(address.sun_path, path.c_str(), path.size());
  OwnedDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::connect(socket.fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const bool is_closed = errno == EACCES || errno == EPERM;
    return Error{ErrorCode::kRefused, {is_closed ? "you may not talk to this subsystem" : "no subsystem listens here"},
                 {path}};
  }
  return Client(std::move(socket), path);
}

Result<Client> Client::connect(const std::string& subsystem) {
  const std::string folder(socket_folder().view());
  const char* chosen = std::getenv("CHIMERA_SUBSYSTEM");
  const std::string name = !subsystem.empty() || chosen == nullptr ? subsystem : chosen;
  const auto running = running_subsystems(folder);
  if (running.empty() && name.empty())
    return Error{ErrorCode::kNotFound, {"no subsystem runs; start one with `chimera run FILE`"}, {folder}};
  if (name.empty() && running.size() > 1)
    return Error{ErrorCode::kRefused, {"several subsystems run: " + listed(running) + "; say --subsystem NAME"}, {}};
  const std::string wanted = name.empty() ? running[0] : name;
  if (std::find(running.begin(), running.end(), wanted) != running.end())
    return connect_to(socket_path(folder, wanted));
  const std::string near = nearest(wanted, running);
  const std::string hint = !near.empty()     ? "; did you mean '" + near + "'?"
                           : running.empty() ? "; start one with `chimera run FILE`"
                                             : "; these run: " + listed(running);
  return Error{ErrorCode::kNotFound, {"no subsystem '" + wanted + "' runs" + hint}, {}};
}

bool Client::send(std::string_view line, Nanoseconds until) {
  while (!line.empty()) {
    const ssize_t sent = ::send(socket_.fd, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) line.remove_prefix(static_cast<std::size_t>(sent));
    else if (errno == EINTR) continue;
    else if (errno != EAGAIN || !wait_for(socket_.fd, POLLOUT, until)) return false;
  }
  return true;
}

Client::Got Client::receive(std::string& line, Nanoseconds until) {
  for (std::size_t looked = 0;;) {
    const std::size_t end = input_.find('\n', looked);
    if (end != std::string::npos) {
      line = input_.substr(0, end);
      input_.erase(0, end + 1);
      return Got::kLine;
    }
    looked = input_.size();
    char bytes[1 << 16];
    const ssize_t got = ::recv(socket_.fd, bytes, sizeof bytes, MSG_DONTWAIT);
    if (got > 0) input_.append(bytes, static_cast<std::size_t>(got));
    else if (got == 0 || (errno != EAGAIN && errno != EINTR)) return Got::kClosed;
    else if (errno == EAGAIN && !wait_for(socket_.fd, POLLIN, until)) return Got::kLate;
  }
}

Answer Client::call(std::string_view method) { return call(method, Json::object()); }

Answer Client::call(std::string_view method, const Json& parameters, Nanoseconds limit) {
  const Nanoseconds until = now() + limit;
  const std::uint64_t id = ++last_id_;
  if (!send(request_line(id, method, parameters), until)) return lost();
  for (std::string line;;) {
    const Got got = receive(line, until);
    if (got == Got::kLate) return Answer::error(kNoAnswer, "no answer in time");
    if (got == Got::kClosed) return lost();
    const Json message = Json::parse(line, nullptr, false);
    if (!message.is_object()) return lost();
    if (message.contains("method") && message.contains("params") && message["method"].is_string()) {
      notes_.push_back({message["method"].get<std::string>(), std::make_shared<const Json>(message["params"])});
      continue;
    }
    const Json known = message.value("id", Json(nullptr));
    const bool is_for_all = known.is_null() && message.contains("error");  // the connection itself is refused
    if (known != id && !is_for_all) continue;
    const auto error = message.find("error");
    if (error == message.end()) return Answer::good(message.value("result", Json::object()));
    return Answer::error(error->value("code", 0), error->value("message", std::string("?")),
                         error->value("data", Json::object()));
  }
}

Result<std::optional<Note>> Client::next(Nanoseconds limit) {
  const Nanoseconds until = now() + limit;
  for (std::string line; notes_.empty();) {
    const Got got = receive(line, until);
    if (got == Got::kLate) return std::optional<Note>{};
    if (got == Got::kClosed)
      return Error{ErrorCode::kSystem, {"the connection to the subsystem was lost"}, {path_}};
    const Json message = Json::parse(line, nullptr, false);
    if (message.is_object() && message.contains("method") && message["method"].is_string())
      notes_.push_back({message["method"].get<std::string>(),
                        std::make_shared<const Json>(message.value("params", Json::object()))});
  }
  std::optional<Note> note = std::move(notes_.front());
  notes_.pop_front();
  return note;
}

}  // namespace chimera::control
