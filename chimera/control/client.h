// SPDX-License-Identifier: Apache-2.0
// A client's end of the control protocol: the only place that makes a lost connection again, and that decides what may
// be sent twice.
//
//   the connection is lost while a call waits      the call                  the next call
//   the line was not read, or the server let go    is made again             -
//   it may have been read: a question              is made again             -
//   it may have been read: an act (is_act)         answers kNoConnection     connects anew
//   there were subscriptions                       answers kNoConnection     connects anew, without subscriptions
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/control/rpc_response.h"
#include "chimera/platform/descriptor.h"

namespace chimera::control {

/// A notification of a subscription.
struct Note {
  std::string method;
  std::shared_ptr<const Json> parameters;
};

/// Time limit of a call, the connection included. It is long enough for a restart of the manager.
inline constexpr Nanoseconds kCallLimit = seconds(5);

/// One connection at a time. Move-only. Context: setup; every call blocks, never longer than its limit.
class Client {
 public:
  /// To the subsystem of that name; "" takes CHIMERA_SUBSYSTEM, else the one that runs, of several the one of this
  /// terminal or folder (control/home.h). A name with a '/' is the path of a socket: another user's subsystem. Refuses,
  /// saying what runs, when there is none or the choice is not clear. Refuses, naming the manager, if the queue of the
  /// socket is full for all of `limit`.
  static Result<Client> connect(const std::string& subsystem, Nanoseconds limit = kCallLimit);
  /// To the socket at `path`.
  static Result<Client> connect_to(const std::string& path, Nanoseconds limit = kCallLimit);
  /// To the socket at `path`, connected by the first call.
  static Client at(std::string path) { return {OwnedDescriptor(), std::move(path)}; }

  /// Calls and waits for the answer, also while the manager restarts. The table above says what happens if the
  /// connection is lost during the call. Notifications that arrive before the answer are kept for next().
  /// `silence`: if the manager sends nothing for this time, even when asked for a sign of life, the call ends before
  /// `limit`. kNoAnswer names the process of the manager and says what to do.
  RpcResponse call(std::string_view method, const Json& parameters, Nanoseconds limit = kCallLimit,
                   Nanoseconds silence = kNever);
  RpcResponse call(std::string_view method);
  /// The next notification; nullopt: none came within `limit`. Refuses when the connection is lost, and the
  /// subscriptions with it.
  Result<std::optional<Note>> next(Nanoseconds limit);
  /// Ends the connection, its subscriptions and their notifications; the next call connects anew.
  void drop();
  bool is_connected() const noexcept { return socket_.fd >= 0; }
  /// Readable when a notification may have come: for poll. next() must have been asked until it said nullopt.
  int descriptor() const noexcept { return socket_.fd; }
  const std::string& path() const noexcept { return path_; }

 private:
  enum class Got { kLine, kLate, kSilent, kClosed, kReset, kTooLong };  ///< kReset: what was sent last was not read

  Client(OwnedDescriptor socket, std::string path) : socket_(std::move(socket)), path_(std::move(path)) {}
  Got send(std::string_view line, Nanoseconds until);
  Got receive(std::string& line, Nanoseconds until);
  Got exchange(std::uint64_t id, std::string_view line, Nanoseconds until, Nanoseconds silence, RpcResponse& answer);
  bool reconnect(Nanoseconds until);
  bool comes_again(int code, Nanoseconds until);
  RpcResponse lost(const char* why);
  bool match_response(const std::string& line, std::uint64_t id, RpcResponse& answer);

  OwnedDescriptor socket_;
  std::string path_;
  std::string input_;
  std::deque<Note> notes_;
  std::uint64_t last_id_ = 0;
  bool has_subscribed_ = false;
  bool is_turned_out_ = false;  // the last answer was for no call: ControlServer closed the connection
};

}  // namespace chimera::control
