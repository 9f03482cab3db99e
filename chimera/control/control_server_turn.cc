// SPDX-License-Identifier: Apache-2.0
// In which order the door does what its peers ask for: acts before questions, those of higher roles first; then one
// question, or one piece of a large answer, of each connection in turn, as long as a turn lasts. Within a connection
// nothing is overtaken.
#include "chimera/control/control_server.h"
#include "chimera/control/methods.h"
#include "chimera/control/turn.h"

namespace chimera::control {
namespace {

bool is_open(const Connection& connection) { return !connection.is_closing() && connection.has_room(); }

/// May change something: somebody may depend on it being done.
bool is_act(const Request& request) {
  const MethodRule* rule = find_method(request.method);
  return rule != nullptr && rule->is_act;
}

}  // namespace

void ControlServer::run_turn(Nanoseconds now) {
  const Turn turn;
  for (const auto& [number, connection] : connections_)
    if (connection->has_output()) (void)connection->flush(now);  // answers that came since the last turn
  do {
    while (act(now) && !turn.is_over()) {
    }
  } while (ask(now) && !turn.is_over());
}

/// One act of each connection, if it has nothing else to do before it. False: there was nothing.
bool ControlServer::act(Nanoseconds now) {
  bool did = false;
  for (const Role role : {Role::kConfigure, Role::kOperate})
    for (const auto& [number, connection] : connections_)
      if (connection->peer().role == role) did = act_of(*connection, now) || did;
  return did;
}

bool ControlServer::act_of(Connection& connection, Nanoseconds now) {
  if (!is_open(connection)) return false;
  std::string line;
  const bool reads = connection.next == nullptr && connection.has_short_line() && connection.take_line(line);
  if (reads) on_line(connection, line, now);
  if (connection.next == nullptr || !is_act(*connection.next)) return reads;
  carry_out_next(connection, now);
  (void)connection.flush(now);
  return true;
}

/// One question of the connection whose turn it is, or a piece of the answer to one. False: there was none.
bool ControlServer::ask(Nanoseconds now) {
  auto at = connections_.upper_bound(last_asked_);
  for (std::size_t n = connections_.size(); n > 0; --n, ++at) {
    if (at == connections_.end()) at = connections_.begin();
    Connection& connection = *at->second;
    if (connection.go_on(now)) {
      last_asked_ = at->first;
      return true;
    }
    std::string line;
    if (!is_open(connection) || (connection.next == nullptr && !connection.take_line(line))) continue;
    last_asked_ = at->first;
    if (connection.next == nullptr) on_line(connection, line, now);
    if (connection.next != nullptr) carry_out_next(connection, now);
    return true;
  }
  return false;
}

/// What a new connection has brought, so that it is answered before its place is wanted.
void ControlServer::answer_first(Connection& connection, Nanoseconds now) {
  std::string line;
  if (is_open(connection) && connection.take_line(line)) on_line(connection, line, now);
  if (connection.next != nullptr) carry_out_next(connection, now);
}

void ControlServer::carry_out_next(Connection& connection, Nanoseconds now) {
  const std::unique_ptr<const Request> request = std::move(connection.next);
  carry_out(connection, *request, now);
}

}  // namespace chimera::control
