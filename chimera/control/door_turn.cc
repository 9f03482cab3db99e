// SPDX-License-Identifier: Apache-2.0
// In which order the door does what its peers ask for: acts before questions, those of higher roles first; then one
// question of each connection in turn, as long as a turn lasts. Within a connection nothing is overtaken.
#include "chimera/control/door.h"
#include "chimera/control/methods.h"
#include "chimera/control/turn.h"

namespace chimera::control {
namespace {

bool is_open(const Session& session) { return !session.is_closing() && session.has_room(); }

/// Changes something, if it is legal: somebody may depend on it being done.
bool is_act(const Request& request) {
  const MethodRule* rule = find_method(request.method);
  return rule != nullptr && rule->role > Role::kObserve;
}

}  // namespace

void Door::take_turn(Nanoseconds now) {
  const Turn turn;
  for (const auto& [number, session] : sessions_)
    if (session->has_output()) (void)session->flush(now);  // answers that came since the last turn
  do {
    while (act(now) && !turn.is_over()) {
    }
  } while (ask(now) && !turn.is_over());
}

/// One act of each connection, if it has nothing else to do before it. False: there was nothing.
bool Door::act(Nanoseconds now) {
  bool did = false;
  for (const Role role : {Role::kConfigure, Role::kOperate})
    for (const auto& [number, session] : sessions_)
      if (session->peer().role == role) did = act_of(*session, now) || did;
  return did;
}

bool Door::act_of(Session& session, Nanoseconds now) {
  if (!is_open(session)) return false;
  std::string line;
  const bool reads = session.next == nullptr && session.has_short_line() && session.take_line(line);
  if (reads) take(session, line, now);
  if (session.next == nullptr || !is_act(*session.next)) return reads;
  carry_out_next(session, now);
  (void)session.flush(now);
  return true;
}

/// One question of the connection whose turn it is. False: there was none.
bool Door::ask(Nanoseconds now) {
  auto at = sessions_.upper_bound(last_asked_);
  for (std::size_t n = sessions_.size(); n > 0; --n, ++at) {
    if (at == sessions_.end()) at = sessions_.begin();
    Session& session = *at->second;
    std::string line;
    if (!is_open(session) || (session.next == nullptr && !session.take_line(line))) continue;
    last_asked_ = at->first;
    if (session.next == nullptr) take(session, line, now);
    if (session.next != nullptr) carry_out_next(session, now);
    return true;
  }
  return false;
}

/// What a new connection has brought, so that it is answered before its place is wanted.
void Door::take_first(Session& session, Nanoseconds now) {
  std::string line;
  if (is_open(session) && session.take_line(line)) take(session, line, now);
  if (session.next != nullptr) carry_out_next(session, now);
}

void Door::carry_out_next(Session& session, Nanoseconds now) {
  const std::unique_ptr<const Request> request = std::move(session.next);
  carry_out(session, *request, now);
}

}  // namespace chimera::control
