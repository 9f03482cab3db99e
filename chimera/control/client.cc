// SPDX-License-Identifier: Apache-2.0
// Finds a subsystem, and exchanges lines with its manager within a limit of time.
#include "chimera/control/client.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/home.h"
#include "chimera/control/listeners.h"
#include "chimera/control/methods.h"
#include "chimera/control/request.h"
#include "chimera/control/running.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/socket_place.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"
#include "chimera/text/time_text.h"

namespace chimera::control {
namespace {

constexpr const char* kLost = "the connection to the subsystem was lost";
constexpr Nanoseconds kWhoIsIt = milliseconds(500);       // for one of several to say where it was started
constexpr Nanoseconds kTryAgain = milliseconds(50);       // when there was no place
constexpr std::size_t kMaxInput = std::size_t{64} << 20;  // of one line

Nanoseconds now() { return LinuxClock().now(); }

bool wait_for(Watched watched, Nanoseconds until) {
  for (;;) {
    const int n = await_ready({&watched, 1}, std::min(until - now(), seconds(60)));
    if (n > 0) return true;
    if (n == 0 && now() >= until) return false;
  }
}

Error refusal(const std::string& text, const std::string& where = {}) {
  return Message(text).error(ErrorCode::kRefused, where);
}

/// False for a method that this client does not know: it may be an act.
bool may_be_sent_twice(std::string_view method) {
  const MethodRule* rule = find_method(method);
  return rule != nullptr && !rule->is_act;
}

std::string silent(const std::string& path, Nanoseconds limit) { return silence_text(path, listeners_at(path), limit); }

Result<OwnedDescriptor> connected(const std::string& path, Nanoseconds limit) {
  auto socket = connect_to_path(path, limit);
  if (socket.fd >= 0) return socket;
  if (errno == ENAMETOOLONG) return refusal("the path of the socket is too long", path);
  if (errno == EAGAIN || errno == EINTR) return refusal(silent(path, limit));
  const bool is_closed = errno == EACCES || errno == EPERM;
  return refusal(is_closed ? "you have no right to connect to this subsystem" : "no subsystem listens here", path);
}

/// The subsystems among `names` that were started from this terminal or folder.
std::vector<std::string> those_here(const std::string& folder, const std::vector<std::string>& names) {
  std::vector<std::string> here;
  for (const std::string& name : names) {
    auto client = Client::connect_to(socket_path(folder, name), kWhoIsIt);
    if (!client) continue;
    const RpcResponse hello = client->call("hello", Json::object(), kWhoIsIt);
    if (hello.is_good() && is_here(home_of(*hello.result))) here.push_back(name);
  }
  return here;
}

Json or_object(const Json* found) { return found == nullptr ? Json::object() : *found; }

/// A message of the other end, whatever it is: never more than an answer or a note.
RpcResponse answer_of(const Json& message) {
  const Json* error = message.find("error");
  if (error == nullptr) return RpcResponse::good(or_object(message.find("result")));
  const Json &code = (*error)["code"], &words = (*error)["message"];
  if (!code.is_whole() || !words.is_string())
    return RpcResponse::error(kNoConnection, "the other end does not speak the control protocol");
  return RpcResponse::error(static_cast<int>(code.as_int64()), words.as_string(), or_object(error->find("data")));
}

}  // namespace

Result<Client> Client::connect_to(const std::string& path, Nanoseconds limit) {
  auto socket = connected(path, limit);
  if (!socket) return socket.error();
  return Client(*std::move(socket), path);
}

bool Client::reconnect(Nanoseconds until) {
  auto socket = connected(path_, until - now());
  if (!socket) return false;
  socket_ = *std::move(socket);
  input_.clear();
  return true;
}

void Client::drop() {
  socket_ = OwnedDescriptor();
  input_.clear();
  notes_.clear();
  has_subscribed_ = false;
}

/// Answers kNoConnection. The caller learns from it that its subscriptions are gone.
RpcResponse Client::lost(const char* why) {
  socket_ = OwnedDescriptor();
  has_subscribed_ = false;
  return RpcResponse::error(kNoConnection, why);
}

Result<Client> Client::connect(const std::string& subsystem, Nanoseconds limit) {
  const char* chosen = std::getenv("CHIMERA_SUBSYSTEM");
  const std::string name = !subsystem.empty() || chosen == nullptr ? subsystem : chosen;
  const std::string folder = folder_with(name, std::string(socket_folder().view()), kServiceFolder);
  if (name.find('/') != std::string::npos) return connect_to(name, limit);
  auto running = running_subsystems(folder);
  if (running.empty() && name.empty())
    return Message("no subsystem runs; start one with `chimera run FILE`").error(ErrorCode::kNotFound, folder);
  if (!running.empty() && folder != kServiceFolder && !is_safe_folder(folder.c_str()))
    return refusal("others may write to the folder of the sockets", folder);
  if (name.empty() && running.size() > 1) {
    const auto here = those_here(folder, running);
    if (here.size() != 1) return refusal("several subsystems run: " + join(running, ", ") + "; say --subsystem NAME");
    running = here;
  }
  const std::string wanted = name.empty() ? running[0] : name;
  if (std::find(running.begin(), running.end(), wanted) != running.end())
    return connect_to(socket_path(folder, wanted), limit);
  const std::string near = nearest(wanted, running);
  const std::string hint = !near.empty()     ? did_you_mean(near)
                           : running.empty() ? "; start one with `chimera run FILE`"
                                             : "; these run: " + join(running, ", ");
  return Message("no subsystem '" + wanted + "' runs" + hint).error(ErrorCode::kNotFound);
}

Client::Got Client::send(std::string_view line, Nanoseconds until) {
  while (!line.empty()) {
    const std::int64_t sent = send_now(socket_.fd, line);
    if (sent >= 0)
      line.remove_prefix(static_cast<std::size_t>(sent));
    else if (errno == EAGAIN && !wait_for({socket_.fd, true}, until))
      return Got::kLate;
    else if (errno != EAGAIN && errno != EINTR)
      return Got::kReset;
  }
  return Got::kLine;
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
    if (looked > kMaxInput) return Got::kTooLong;
    char bytes[1 << 16];
    const std::int64_t got = receive_now(socket_.fd, bytes);
    if (got > 0)
      input_.append(bytes, static_cast<std::size_t>(got));
    else if (got == 0)
      return Got::kClosed;
    else if (errno == EAGAIN && !wait_for({socket_.fd}, until))
      return Got::kLate;
    else if (errno != EAGAIN && errno != EINTR)
      return Got::kReset;  // the other end closed with our line unread
  }
}

/// Keeps a note, or takes the answer to `id` and is true; what is neither is passed over.
bool Client::match_response(const std::string& line, std::uint64_t id, RpcResponse& answer) {
  const Json message = Json::parse_or_none(line).value_or(nullptr);
  if (!message.is_object()) return false;
  if (const Json& method = message["method"]; method.is_string()) {
    notes_.push_back({method.as_string(), std::make_shared<const Json>(or_object(message.find("params")))});
    return false;
  }
  const Json& known = message["id"];
  const bool is_for_all = known.is_null();  // the connection itself is refused
  if (id == 0 || (is_for_all ? !message.contains("error") : known != id)) return false;
  answer = answer_of(message);
  is_turned_out_ = is_for_all && (answer.code == kClosed || answer.code == kTooMany);
  return true;
}

/// Asks for a sign of life when half of `silence` has passed without a word.
Client::Got Client::exchange(std::uint64_t id, std::string_view line, Nanoseconds until, Nanoseconds silence,
                             RpcResponse& answer) {
  const auto within = [&](Nanoseconds time) { return until - now() > time ? now() + time : until; };
  const Got sent = send(line, within(silence));
  if (sent == Got::kLate) return now() >= until ? sent : Got::kSilent;
  bool is_asked = false;
  for (std::string text;;) {  // even if it could not be sent: why not may stand there to read
    const Got got = receive(text, within(silence == kNever ? silence : Nanoseconds{silence.count / 2}));
    if (got == Got::kLate) {
      if (now() >= until) return got;
      if (std::exchange(is_asked, true)) return Got::kSilent;
      (void)send(request_line(++last_id_, "hello", Json::object()), now());
      continue;
    }
    if (got != Got::kLine) return sent == Got::kReset && got == Got::kClosed ? sent : got;
    is_asked = false;
    if (match_response(text, id, answer)) return got;
  }
}

RpcResponse Client::call(std::string_view method) { return call(method, Json::object()); }

/// Connects anew after ControlServer closed this connection or had no place for it. ControlServer has then carried
/// out no call that it did not answer.
bool Client::comes_again(int code, Nanoseconds until) {
  if (code == kTooMany && until - now() > kTryAgain) await_readable({}, kTryAgain);
  return !has_subscribed_ && until - now() > kTryAgain && reconnect(until);
}

RpcResponse Client::call(std::string_view method, const Json& parameters, Nanoseconds limit, Nanoseconds silence) {
  const Nanoseconds until = now() + limit;
  const std::uint64_t id = ++last_id_;
  const std::string line = request_line(id, method, parameters);
  if (!is_connected() && !reconnect(until)) return lost(kLost);
  for (;;) {
    RpcResponse answer;
    const Got got = exchange(id, line, until, silence, answer);
    if (got == Got::kLine && is_turned_out_) {
      if (comes_again(answer.code, until)) continue;
      return answer.code == kClosed ? lost(kLost) : answer;
    }
    if (got == Got::kLine) {
      has_subscribed_ = has_subscribed_ || (method == "subscribe" && answer.is_good());
      return answer;
    }
    if (got == Got::kLate && silence < limit)  // the manager lives
      return RpcResponse::error(kNoAnswer,
                                "no answer within " + time_text(limit) + "; `chimera status` says what was done");
    if (got == Got::kLate || got == Got::kSilent)
      return RpcResponse::error(kNoAnswer, silent(path_, std::min(limit, silence)));
    if (got == Got::kTooLong)
      return lost("the answer has more than 64 MiB: ask for less, of `get` for some of the variables only");
    if (got == Got::kClosed && !may_be_sent_twice(method))
      return lost("the manager ended before it answered; `chimera status` says what was done");
    if (has_subscribed_ || now() >= until || !reconnect(until)) return lost(kLost);
  }
}

Result<std::optional<Note>> Client::next(Nanoseconds limit) {
  const Nanoseconds until = now() + limit;
  RpcResponse ignored;
  for (std::string line; notes_.empty();) {
    const Got got = receive(line, until);
    if (got == Got::kLate) return std::optional<Note>{};
    if (got != Got::kLine) {
      (void)lost(kLost);
      return Message(kLost).error(ErrorCode::kSystem, path_);
    }
    (void)match_response(line, 0, ignored);
  }
  std::optional<Note> note = std::move(notes_.front());
  notes_.pop_front();
  return note;
}

}  // namespace chimera::control
