// SPDX-License-Identifier: Apache-2.0
// A face's end of the control protocol.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/control/answer.h"
#include "chimera/platform/linux/owned_descriptor.h"

namespace chimera::control {

/// A notification of a subscription.
struct Note {
  std::string method;
  std::shared_ptr<const Json> parameters;
};

/// One connection. Move-only. Context: setup; every call blocks, never longer than its limit.
class Client {
 public:
  /// To the subsystem of that name; "" takes CHIMERA_SUBSYSTEM, else the one that runs. Refuses, saying what runs,
  /// when there is none or the choice is not clear.
  static Result<Client> connect(const std::string& subsystem);
  /// To the socket at `path`.
  static Result<Client> connect_to(const std::string& path);

  /// Calls and waits for the answer; a manager that is being restarted is waited for. A connection that is lost
  /// answers kNoConnection. Notifications that come meanwhile are kept for next().
  Answer call(std::string_view method, const Json& parameters, Nanoseconds limit = seconds(10));
  Answer call(std::string_view method) ;
  /// The next notification; nullopt: none came within `limit`. Refuses when the connection is lost.
  Result<std::optional<Note>> next(Nanoseconds limit);
  /// Readable when a notification may have come: for poll. next() must have been asked until it said nullopt.
  int descriptor() const noexcept { return socket_.fd; }
  const std::string& path() const noexcept { return path_; }

 private:
  Client(OwnedDescriptor socket, std::string path) : socket_(std::move(socket)), path_(std::move(path)) {}
  bool send(std::string_view line, Nanoseconds until);
  /// A line, or why there is none: kClosed, or kLate at `until`.
  enum class Got { kLine, kLate, kClosed };
  Got receive(std::string& line, Nanoseconds until);

  OwnedDescriptor socket_;
  std::string path_;
  std::string input_;
  std::deque<Note> notes_;
  std::uint64_t last_id_ = 0;
};

}  // namespace chimera::control
