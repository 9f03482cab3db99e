// SPDX-License-Identifier: Apache-2.0
// Takes the requests of all connections in their order, judges each, and hands it to the backend: acts before
// questions, those of higher roles first; then one question, or one piece of a large answer, of each connection in
// turn, as long as a turn lasts. Within a connection nothing is overtaken. docs/formats/control.md, "Limits".
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "chimera/control/connection.h"
#include "chimera/control/control_backend.h"
#include "chimera/control/methods.h"
#include "chimera/control/subscriptions.h"

namespace chimera::control {

/// Single-threaded. Context: setup; never blocks.
class Dispatcher {
 public:
  /// All three outlive it.
  Dispatcher(ControlBackend& backend, Subscriptions& subscriptions, const Connections& connections)
      : backend_(backend), subscriptions_(subscriptions), connections_(connections) {}
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;
  ~Dispatcher() { *is_alive_ = false; }

  /// Carries out what has come, until nothing is left or the turn is over.
  void run_turn(Nanoseconds now);
  /// Carries out the first request of a new connection, so that it is answered before its place is wanted.
  void answer_first(Connection& connection, Nanoseconds now);
  /// An answer was given since the last settle(): something may wait to be sent.
  bool has_answered() const noexcept { return has_answered_; }
  void settle() noexcept { has_answered_ = false; }

 private:
  struct Call;

  bool act(Nanoseconds now);
  bool act_of(Connection& connection, Nanoseconds now);
  bool ask(Nanoseconds now);
  void read(Connection& connection, const std::string& line, Nanoseconds now);
  void carry_out_next(Connection& connection, Nanoseconds now);
  void carry_out(Connection& connection, const Request& request, Nanoseconds now);
  RpcResponse judge(Connection& connection, const Request& request, const MethodRule* rule, Nanoseconds now);
  RpcResponse subscribe(Connection& connection, const Json& parameters, Nanoseconds now);
  void answer(Connection& connection, const Request& request, const RpcResponse& answer);

  ControlBackend& backend_;
  Subscriptions& subscriptions_;
  const Connections& connections_;
  Nanoseconds now_;               // of the last turn: of an answer that comes later
  std::uint64_t last_asked_ = 0;  // whose question was answered last
  bool has_answered_ = false;
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);  // for replies that come after the end
};

}  // namespace chimera::control
