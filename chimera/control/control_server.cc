// SPDX-License-Identifier: Apache-2.0
// Accepts connections, gives them places, reads and sends for them, and ends them.
#include "chimera/control/control_server.h"

#include <algorithm>
#include <vector>

#include "chimera/platform/local_socket.h"
#include "chimera/text/json.h"
#include "chimera/text/time_text.h"

namespace chimera::control {
namespace {

constexpr std::uint64_t kListening = 0;                  // in watched_; connections count from 1
constexpr int kAcceptAtOnce = 64;                        // a crowd of strangers must not stop the others
constexpr Nanoseconds kAcceptPause = milliseconds(100);  // when there is no descriptor left

RpcResponse no_role() {
  return RpcResponse::error(
      kNoRight, "you have no role in this subsystem: you are neither its user nor in a group that has a role",
      {{"needs", "observe"}, {"has", "nothing"}});
}

}  // namespace

Result<std::unique_ptr<ControlServer>> ControlServer::open(int listening, ControlBackend& backend, uid_t owner,
                                                           const RoleGroups& groups) {
  std::unique_ptr<ControlServer> server(new ControlServer(backend, owner, groups));
  server->listening_ = OwnedDescriptor(listening);
  const Message what("the control socket cannot be watched");
  auto watched = DescriptorSet::open(what);
  if (!watched) return watched.error();
  server->watched_ = *std::move(watched);
  if (listening >= 0 && !server->watched_.add(listening, kToRead, kListening)) return system_error(what, "epoll");
  return server;
}

void ControlServer::serve(Nanoseconds now) {
  now_ = now;
  if (now >= accepts_again_) {
    accepts_again_ = kNever;
    watched_.change(listening_.fd, kToRead, kListening);
  }
  DescriptorSet::Ready ready[kMaxConnections + 1];
  const std::size_t n = watched_.take(ready);
  bool has_callers = false;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint64_t number = ready[i].number;
    const auto found = connections_.find(number);
    has_callers = has_callers || number == kListening;
    if (found == connections_.end() || !ready[i].is_readable) continue;
    found->second->receive(now);
    if (ready[i].has_ended) found->second->is_gone = true;
  }
  dispatcher_.run_turn(now);
  if (has_callers) accept(now);  // after run_turn(): a connection that has just asked does not count as idle
  subscriptions_.notify([this](std::uint64_t number) -> Connection& { return *connections_.at(number); }, now);
  settle(now);
}

Activity ControlServer::activity(Connection& connection, Nanoseconds now) const {
  if (connection.open_acts > 0) return Activity::kActs;
  const bool listens = subscriptions_.count_of(connection.number()) > 0 && connection.is_read(now);
  if (listens && !connection.is_gone) return Activity::kListens;
  if (connection.open_calls > 0 || connection.has_line() || connection.has_output()) return Activity::kAsks;
  return connection.half_since() != kNever ? Activity::kHalfLine : Activity::kIdle;
}

/// A place for one more, or why there is none.
RpcResponse ControlServer::admit(const PeerIdentity& peer, Nanoseconds now) {
  if (peer.role == Role::kNone) return no_role();
  std::vector<Occupant> all;
  for (const auto& [number, connection] : connections_) {
    const Activity has = activity(*connection, now);
    all.push_back({number, connection->peer().user, rank_of(connection->peer(), owner_), has,
                   has == Activity::kHalfLine ? connection->half_since() : connection->active_at});
  }
  const PlaceGrant placement = find_place(all, peer.user, rank_of(peer, owner_));
  if (!placement.is_granted) return RpcResponse::error(kTooMany, "too many connections: " + placement.refusal);
  if (placement.in_place_of == 0) return {};
  Connection& first = *connections_.at(placement.in_place_of);
  evict(first, idle_text(first, now) + "; its place was needed", now);
  end(first.number());
  return {};
}

std::string ControlServer::idle_text(Connection& connection, Nanoseconds now) const {
  switch (activity(connection, now)) {
    case Activity::kHalfLine:
      return "a line without an end for " + time_text(now - connection.half_since());
    case Activity::kIdle:
      return "idle for " + time_text(now - connection.active_at);
    case Activity::kAsks:
      return "the client had sent requests only, no act";
    case Activity::kListens:
      return "the client had subscriptions only, and a lower role";
    case Activity::kActs:
      break;  // does not give way
  }
  return "";
}

/// Sends the reason to the peer, if that is possible at once, and adds it to `closings_`.
void ControlServer::evict(Connection& connection, const std::string& why, Nanoseconds now) {
  connection.queue(answer_line(nullptr, RpcResponse::error(kClosed, "closed: " + why)), now);
  (void)connection.flush(now);
  const PeerIdentity& peer = connection.peer();
  const std::string process = peer.process > 0 ? "process " + std::to_string(peer.process) + ", " : "";
  closings_.add(
      peer.user,
      "a connection of user " + std::to_string(peer.user) + " (" + process + role_name(peer.role) + "): " + why, now);
}

void ControlServer::accept(Nanoseconds now) {
  for (int n = 0; n < kAcceptAtOnce; ++n) {
    OwnedDescriptor connected = accept_now(listening_.fd);
    if (connected.fd >= 0) {
      const PeerIdentity peer = identify(connected.fd, owner_, groups_);
      enter(std::move(connected), peer, now);
    } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      accepts_again_ = now + kAcceptPause;  // the socket stays readable: not to be woken by it all the time
      watched_.change(listening_.fd, 0, kListening);
      return;
    } else if (errno != EINTR && errno != ECONNABORTED) {
      return;
    }
  }
}

void ControlServer::enter(OwnedDescriptor connected, const PeerIdentity& peer, Nanoseconds now) {
  auto connection = std::make_unique<Connection>(++last_connection_, std::move(connected), peer, now);
  if (peer.role != Role::kNone) connection->receive(now);  // a peer with only one question has already sent it
  if (connection->has_ended() && !connection->has_line()) return;
  if (const RpcResponse refusal = admit(peer, now); !refusal.is_good()) {
    connection->queue(answer_line(nullptr, refusal), now);
    (void)connection->flush(now);
    return;
  }
  connection->watched = kToRead;
  if (!watched_.add(connection->descriptor(), kToRead, connection->number())) return;
  Connection& entered = *connections_.emplace(connection->number(), std::move(connection)).first->second;
  dispatcher_.answer_first(entered, now);  // the next one in the queue may need its place
  (void)entered.flush(now);
}

/// Lines that a peer sent before it went are still carried out. A peer that has ended its side but still reads gets
/// its answers and notifications.
bool ControlServer::is_over(Connection& connection, Nanoseconds now) {
  if (connection.is_gone && !connection.has_line()) return true;
  const bool wants_more =
      connection.open_calls > 0 || connection.has_line() || subscriptions_.count_of(connection.number()) > 0;
  if (connection.has_ended() && !wants_more) connection.close_after();
  const bool has_more_to_do =
      connection.has_ended() && connection.has_line() && connection.has_room() && !connection.is_closing();
  return !connection.flush(now) && !has_more_to_do;
}

/// For which it is closed now; null: none.
const char* ControlServer::fault_of(Connection& connection, Nanoseconds now) const {
  if (connection.is_closing() || connection.is_gone) return nullptr;
  if (connection.send_timeout() <= now) return "the client read nothing for 5 s";
  const Nanoseconds half = connection.has_line() ? kNever : connection.half_since();
  return half != kNever && now - half >= kStalledPeerLimit ? "the client sent a line without its end for 5 s" : nullptr;
}

void ControlServer::settle(Nanoseconds now) {
  std::vector<std::uint64_t> over;
  bool waits = false;
  for (const auto& [number, connection] : connections_) {
    const bool is_gone = is_over(*connection, now);
    const char* fault = fault_of(*connection, now);
    if (fault != nullptr) evict(*connection, fault, now);
    if (is_gone || fault != nullptr) {
      over.push_back(number);
      continue;
    }
    const bool listens = connection->has_room() && !connection->is_closing() && !connection->has_ended();
    if (!listens) connection->restart_line_timer(now);
    const std::uint32_t wanted = (listens ? kToRead : 0u) | (connection->has_output() ? kToWrite : 0u);
    if (wanted != connection->watched) watched_.change(connection->descriptor(), wanted, number);
    connection->watched = wanted;
    waits = waits || connection->can_go_on() ||
            (!connection->is_closing() && connection->has_room() && connection->has_line());
  }
  for (const std::uint64_t number : over) end(number);
  closings_.report_due(now);
  dispatcher_.settle();
  has_more_ = waits;
}

void ControlServer::end(std::uint64_t connection) {
  subscriptions_.end(connection);
  connections_.erase(connection);
  backend_.forget(connection);
}

Nanoseconds ControlServer::next_due() const noexcept {
  if (has_more_ || dispatcher_.has_answered()) return now_;
  Nanoseconds next = std::min({subscriptions_.next_due(), accepts_again_, closings_.next_due()});
  for (const auto& [number, connection] : connections_) {
    const bool has_half = connection->half_since() != kNever && !connection->has_line();
    const Nanoseconds half_due = has_half ? connection->half_since() + kStalledPeerLimit : kNever;
    next = std::min({next, connection->send_timeout(), half_due});
  }
  return next;
}

}  // namespace chimera::control
