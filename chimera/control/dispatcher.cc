// SPDX-License-Identifier: Apache-2.0
// Decides whose request is next, judges it by the row of its method, and sends the answer back.
#include "chimera/control/dispatcher.h"

#include <algorithm>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/turn.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"

namespace chimera::control {
namespace {

bool is_open(const Connection& connection) { return !connection.is_closing() && connection.has_room(); }

/// True if the request may change something, so that its caller may depend on it being done.
bool is_act(const Request& request) {
  const MethodRule* rule = find_method(request.method);
  return rule != nullptr && rule->is_act;
}

RpcResponse too_fast(Nanoseconds wait) {
  return RpcResponse::error(kTooFast, "too many requests", {{"retry_ms", (wait.count + 999'999) / 1'000'000}});
}

/// Null: it is small enough to be sent at once.
std::shared_ptr<Pieces> pieces_of(const RpcResponse& answer) {
  if (answer.text == nullptr || answer.text->size() <= kPiece) return answer.pieces;
  return std::make_shared<TextPieces>(answer.text, *answer.text);
}

RpcResponse no_method(const std::string& name) {
  const std::string near = name.size() < 40 ? nearest(name, names_of(methods(), &MethodRule::name)) : "";
  RpcResponse unknown = RpcResponse::unknown("no method '" + name.substr(0, 40) + "'", "method", near);
  unknown.code = kNoMethod;
  return unknown;
}

}  // namespace

/// The one answer of a call that was handed to the backend. The first answer counts. If the reply is dropped without
/// an answer, the caller gets kNoAnswer.
struct Dispatcher::Call {
  Call(Dispatcher& made_by, Connection& from, const Request& asked, bool does_act)
      : dispatcher(&made_by), is_alive(made_by.is_alive_), connection(from.number()), request(asked), acts(does_act) {
    ++from.open_calls;
    from.open_acts += acts;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() {
    if (!is_answered) finish(RpcResponse::error(kNoAnswer, "the subsystem gave no answer"));
  }
  void finish(const RpcResponse& response) {
    if (std::exchange(is_answered, true) || !*is_alive) return;
    const auto found = dispatcher->connections_.find(connection);
    if (found == dispatcher->connections_.end()) return;
    --found->second->open_calls;
    found->second->open_acts -= acts;
    dispatcher->answer(*found->second, request, response);
  }

  Dispatcher* dispatcher;
  std::shared_ptr<bool> is_alive;
  std::uint64_t connection;
  Request request;
  bool acts;
  bool is_answered = false;
};

void Dispatcher::run_turn(Nanoseconds now) {
  now_ = now;
  const Turn turn;
  for (const auto& [number, connection] : connections_)
    if (connection->has_output()) (void)connection->flush(now);  // answers that came since the last turn
  do {
    while (act(now) && !turn.is_over()) {
    }
  } while (ask(now) && !turn.is_over());
}

/// One act of each connection, if it has nothing else to do before it. False: there was nothing.
bool Dispatcher::act(Nanoseconds now) {
  bool did = false;
  for (const Role role : {Role::kConfigure, Role::kOperate})
    for (const auto& [number, connection] : connections_)
      if (connection->peer().role == role) did = act_of(*connection, now) || did;
  return did;
}

bool Dispatcher::act_of(Connection& connection, Nanoseconds now) {
  if (!is_open(connection)) return false;
  std::string line;
  const bool reads = connection.next == nullptr && connection.has_short_line() && connection.take_line(line);
  if (reads) read(connection, line, now);
  if (connection.next == nullptr || !is_act(*connection.next)) return reads;
  carry_out_next(connection, now);
  (void)connection.flush(now);
  return true;
}

/// One question of the connection whose turn it is, or a piece of the answer to one. False: there was none.
bool Dispatcher::ask(Nanoseconds now) {
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
    if (connection.next == nullptr) read(connection, line, now);
    if (connection.next != nullptr) carry_out_next(connection, now);
    return true;
  }
  return false;
}

void Dispatcher::answer_first(Connection& connection, Nanoseconds now) {
  std::string line;
  if (is_open(connection) && connection.take_line(line)) read(connection, line, now);
  if (connection.next != nullptr) carry_out_next(connection, now);
}

void Dispatcher::carry_out_next(Connection& connection, Nanoseconds now) {
  const std::unique_ptr<const Request> request = std::move(connection.next);
  carry_out(connection, *request, now);
}

/// Reads a line: what is no request, or may not be one now, is answered; else it is the connection's next.
void Dispatcher::read(Connection& connection, const std::string& line, Nanoseconds now) {
  connection.active_at = now;
  const std::size_t pieces = 1 + std::min(line.size(), kMaxLine) / kLongLine;
  const bool may = connection.requests.try_take(now, static_cast<std::int64_t>(pieces));
  const RpcResponse refusal =
      may ? RpcResponse{} : too_fast(connection.requests.wait(now, static_cast<std::int64_t>(pieces)));
  const bool is_long = pieces > 1 && line.size() <= kMaxLine;
  if (!may && is_long) return connection.queue(answer_line(nullptr, refusal), now);  // its id is not worth the search
  const Request request = read_request(line);
  if (!request.refusal.is_good()) {
    connection.queue(answer_line(*request.id, request.refusal), now);
    if (request.must_close) connection.close_after();
  } else if (!may) {
    answer(connection, request, refusal);
  } else {
    connection.next = std::make_unique<const Request>(request);
  }
}

void Dispatcher::carry_out(Connection& connection, const Request& request, Nanoseconds now) {
  const MethodRule* rule = find_method(request.method);
  const RpcResponse judged = judge(connection, request, rule, now);
  if (!judged.is_good()) return answer(connection, request, judged);
  if (rule->id == MethodId::kSubscribe)
    return answer(connection, request, subscribe(connection, *request.parameters, now));
  if (rule->id == MethodId::kUnsubscribe)
    return answer(connection, request, subscriptions_.close(connection.number(), *request.parameters));
  auto call = std::make_shared<Call>(*this, connection, request, rule->is_act);
  backend_.call(*rule, *request.parameters, {connection.peer().role, connection.number(), connection.peer().user},
                [call = std::move(call)](const RpcResponse& said) { call->finish(said); });
}

RpcResponse Dispatcher::judge(Connection& connection, const Request& request, const MethodRule* rule, Nanoseconds now) {
  if (rule == nullptr) return no_method(request.method);
  const Role has = connection.peer().role;
  if (has < rule->role)
    return RpcResponse::error(
        kNoRight,
        std::string("'") + rule->name + "' needs the role " + role_name(rule->role) + ", you have " + role_name(has),
        {{"needs", role_name(rule->role)}, {"has", role_name(has)}});
  if ((rule->is_act || rule->is_costly) && !connection.acts.try_take(now)) return too_fast(connection.acts.wait(now));
  return check_parameters(*rule, *request.parameters);
}

/// Some places of a user are kept for connections without subscriptions, which bring one question or act.
RpcResponse Dispatcher::subscribe(Connection& connection, const Json& parameters, Nanoseconds now) {
  const auto is_one = [&](const auto& one) {
    return one.second->peer().user == connection.peer().user && subscriptions_.count_of(one.first) > 0;
  };
  const auto listeners = std::count_if(connections_.begin(), connections_.end(), is_one);
  if (subscriptions_.count_of(connection.number()) == 0 && listeners >= static_cast<long>(kMaxListenersOfUser))
    return RpcResponse::error(kTooMany, "too many connections: " + std::to_string(kMaxListenersOfUser) + " of user " +
                                            std::to_string(connection.peer().user) + " have subscriptions");
  return subscriptions_.open(connection.number(), parameters, now);
}

void Dispatcher::answer(Connection& connection, const Request& request, const RpcResponse& answer) {
  connection.active_at = now_;
  if (!request.wants_answer) return;
  if (auto pieces = pieces_of(answer); pieces != nullptr)
    connection.queue_in_pieces(result_begin(*request.id), std::move(pieces), kResultEnd, now_);
  else
    connection.queue(answer_line(*request.id, answer), now_);
  has_answered_ = true;
}

}  // namespace chimera::control
