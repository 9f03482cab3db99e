// SPDX-License-Identifier: Apache-2.0
// The subscriptions of all connections, and the times at which their notifications are due.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "chimera/control/connection.h"
#include "chimera/control/control_backend.h"

namespace chimera::control {

/// Context: setup.
class Subscriptions {
 public:
  explicit Subscriptions(ControlBackend& backend) : backend_(backend) {}

  /// Answers `subscribe` and `unsubscribe` of a connection; `parameters` have been checked.
  RpcResponse open(std::uint64_t connection, const Json& parameters, Nanoseconds now);
  RpcResponse close(std::uint64_t connection, const Json& parameters);
  /// The connection is over.
  void end(std::uint64_t connection);
  std::size_t count_of(std::uint64_t connection) const noexcept;

  /// Sends to every connection the notifications that are due and that it has room for. A periodic notification is made
  /// after the peer has taken all earlier ones, so a slow peer skips to the latest. `connection_of` finds a connection
  /// by number. Ends with the turn. Subscriptions that are left are due at once, and come first in the next turn.
  void notify(const std::function<Connection&(std::uint64_t)>& connection_of, Nanoseconds now);
  /// Time at which notify() is due; kNever: there are no subscriptions.
  Nanoseconds next_due() const noexcept;

 private:
  struct Subscription {
    std::uint64_t connection = 0;
    std::string to;
    Nanoseconds period;
    bool skips = false;  ///< to the latest
    Nanoseconds due;
  };

  ControlBackend& backend_;
  std::map<std::uint64_t, Subscription> all_;
  std::uint64_t last_ = 0;
  std::uint64_t last_told_ = 0;
};

}  // namespace chimera::control
