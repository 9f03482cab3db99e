// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/door.h"

#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "chimera/config/nearest.h"
#include "chimera/control/request.h"

namespace chimera::control {
namespace {

constexpr std::uint64_t kListening = 0;                // of epoll; sessions count from 1
constexpr Nanoseconds kLookAtNews = milliseconds(10);  // for subscriptions without a period
constexpr const char* kTopics[] = {"status", "events", "values", "tap"};

bool watch(int epoll, int operation, int descriptor, std::uint32_t events, std::uint64_t number) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = number;
  return ::epoll_ctl(epoll, operation, descriptor, &event) == 0;
}

}  // namespace

Result<std::unique_ptr<Door>> Door::open(int listening, Subject& subject, uid_t owner, const RoleGroups& groups) {
  std::unique_ptr<Door> door(new Door(subject, owner, groups));
  door->listening_ = OwnedDescriptor(listening);
  door->epoll_ = OwnedDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  if (door->epoll_.fd < 0 || !watch(door->epoll_.fd, EPOLL_CTL_ADD, listening, EPOLLIN, kListening))
    return Error{ErrorCode::kSystem, {"the control socket cannot be watched"}, {}};
  return door;
}

Door::~Door() { *is_alive_ = false; }

void Door::serve(Nanoseconds now) {
  epoll_event events[32];
  const int n = ::epoll_wait(epoll_.fd, events, 32, 0);
  for (int i = 0; i < n; ++i) {
    if (events[i].data.u64 == kListening) {
      accept(now);
      continue;
    }
    const auto found = sessions_.find(events[i].data.u64);
    if (found == sessions_.end()) continue;
    if ((events[i].events & (EPOLLIN | EPOLLHUP | EPOLLERR)) != 0) found->second->receive();
  }
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, session] : sessions_) numbers.push_back(number);
  for (const std::uint64_t number : numbers) read(*sessions_.at(number), now);
  notify(now);
  flush(now);
}

bool Door::may_enter(const PeerIdentity& peer) const {
  if (sessions_.size() >= kMaxConnections) return false;
  const auto is_same = [&](const auto& one) { return one.second->peer().user == peer.user; };
  return std::count_if(sessions_.begin(), sessions_.end(), is_same) < static_cast<long>(kMaxConnectionsOfUser);
}

void Door::accept(Nanoseconds now) {
  for (;;) {
    OwnedDescriptor socket(::accept4(listening_.fd, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket.fd < 0) return;
    const PeerIdentity peer = identify(socket.fd, owner_, groups_);
    enter(std::move(socket), peer, now);
  }
}

void Door::enter(OwnedDescriptor socket, const PeerIdentity& peer, Nanoseconds now) {
  const bool enters = may_enter(peer);
  auto session = std::make_unique<Session>(++last_session_, std::move(socket), peer, now);
  if (peer.role == Role::kNone) {
    session->say(answer_line(nullptr, Answer::error(kNoRight, "you have no right here: you are neither the user of the "
                                                              "subsystem nor in a group with a role",
                                                    {{"needs", "observe"}, {"has", "nothing"}})));
  } else if (!enters) {
    session->say(answer_line(nullptr, Answer::error(kTooMany, "too many connections")));
  }
  if (peer.role == Role::kNone || !enters) {
    (void)session->flush(now);
    return;
  }
  watch(epoll_.fd, EPOLL_CTL_ADD, session->descriptor(), EPOLLIN, session->number());
  sessions_.emplace(session->number(), std::move(session));
}

void Door::read(Session& session, Nanoseconds now) {
  std::string line;
  while (!session.is_closing() && session.has_room() && session.take_line(line)) take(session, line, now);
  if (session.has_ended()) session.close_after();  // what it asked is answered as far as it can be at once
}

void Door::take(Session& session, const std::string& line, Nanoseconds now) {
  const Request request = read_request(line);
  const std::uint64_t number = session.number();
  if (!request.refusal.is_good()) {
    answer(number, *request.id, request.refusal);
    if (request.must_close) session.close_after();
    return;
  }
  const MethodRule* rule = find_method(request.method);
  const Answer judged = judge(session, request.method, rule, *request.parameters, now);
  Reply reply = [this, number, id = request.id, wanted = request.wants_answer, alive = is_alive_](const Answer& said) {
    if (*alive && wanted) answer(number, *id, said);
  };
  if (!judged.is_good()) return reply(judged);
  if (request.method == "subscribe") return reply(subscribe(session, *request.parameters, now));
  if (request.method == "unsubscribe") return reply(unsubscribe(session, *request.parameters));
  subject_.call(*rule, *request.parameters, session.peer().role, std::move(reply));
}

Answer Door::judge(Session& session, const std::string& method, const MethodRule* rule, const Json& parameters,
                   Nanoseconds now) {
  const auto too_fast = [now](const Allowance& allowance) {
    const auto ms = (allowance.wait(now).count + 999'999) / 1'000'000;
    return Answer::error(kTooFast, "too many requests", {{"retry_ms", ms}});
  };
  if (!session.requests.take(now)) return too_fast(session.requests);
  if (rule == nullptr) {
    std::vector<std::string> names;
    for (const MethodRule& known : methods()) names.emplace_back(known.name);
    Answer unknown = Answer::unknown("no method '" + method + "'", "method", nearest(method, names));
    unknown.code = kNoMethod;
    return unknown;
  }
  const Role has = session.peer().role;
  if (has < rule->role)
    return Answer::error(kNoRight,
                         std::string("'") + rule->name + "' needs the role " + role_name(rule->role) + ", you have " +
                             role_name(has),
                         {{"needs", role_name(rule->role)}, {"has", role_name(has)}});
  if (rule->is_act && !session.acts.take(now)) return too_fast(session.acts);
  return check_parameters(*rule, parameters);
}

void Door::answer(std::uint64_t session, const Json& id, const Answer& answer) {
  const auto found = sessions_.find(session);
  if (found != sessions_.end()) found->second->say(answer_line(id, answer));
}

Answer Door::subscribe(Session& session, const Json& parameters, Nanoseconds now) {
  const std::string to = parameters.at("to").get<std::string>();
  if (std::find(std::begin(kTopics), std::end(kTopics), to) == std::end(kTopics))
    return Answer::error(kBadParameters, "'to' must be status, events, values or tap", {{"where", "to"}});
  const auto is_of = [&](const auto& one) { return one.second.session == session.number(); };
  if (std::count_if(subscriptions_.begin(), subscriptions_.end(), is_of) >= static_cast<long>(kMaxSubscriptions))
    return Answer::error(kBadParameters, "a connection may have 32 subscriptions", {{"where", "to"}});
  const std::int64_t period_ms = parameters.value("period_ms", std::int64_t{100});
  if (period_ms < 20 || period_ms > 60'000)
    return Answer::error(kBadParameters, "'period_ms' must be from 20 to 60000", {{"where", "period_ms"}});
  const std::uint64_t number = ++last_subscription_;
  const Answer opened = subject_.open(number, parameters);
  if (!opened.is_good()) return opened;
  const bool has_period = to == "status" || to == "values";
  subscriptions_[number] = {session.number(), to, has_period ? milliseconds(period_ms) : Nanoseconds{}, now};
  return Answer::good({{"subscription", number}});
}

Answer Door::unsubscribe(Session& session, const Json& parameters) {
  const auto number = parameters.at("subscription").get<std::uint64_t>();
  const auto found = subscriptions_.find(number);
  if (found == subscriptions_.end() || found->second.session != session.number())
    return Answer::unknown("no subscription " + std::to_string(number), "subscription", "");
  subject_.close(number);
  subscriptions_.erase(found);
  return Answer::good(Json::object());
}

// What has a period is made when it is due and the peer has taken what came before: who is slow skips to the latest.
void Door::notify(Nanoseconds now) {
  for (auto& [number, subscription] : subscriptions_) {
    if (now < subscription.due) continue;
    Session& session = *sessions_.at(subscription.session);
    const bool has_period = subscription.period > Nanoseconds{};
    subscription.due = now + (has_period ? subscription.period : kLookAtNews);
    if (has_period ? session.has_output() : !session.has_room()) continue;
    if (const auto news = subject_.pull(number); news != nullptr)
      session.say(note_line(subscription.to, number, *news));
  }
}

void Door::flush(Nanoseconds now) {
  std::vector<std::uint64_t> gone;
  for (const auto& [number, session] : sessions_) {
    const bool stays = session->flush(now);
    if (!stays)
      gone.push_back(number);
    else
      watch(epoll_.fd, EPOLL_CTL_MOD, session->descriptor(),
            (session->has_room() && !session->is_closing() ? EPOLLIN : 0u) | (session->has_output() ? EPOLLOUT : 0u),
            number);
  }
  for (const std::uint64_t number : gone) end(number);
}

void Door::end(std::uint64_t session) {
  for (auto at = subscriptions_.begin(); at != subscriptions_.end();) {
    if (at->second.session != session) {
      ++at;
      continue;
    }
    subject_.close(at->first);
    at = subscriptions_.erase(at);
  }
  sessions_.erase(session);
}

Nanoseconds Door::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const auto& [number, subscription] : subscriptions_) next = std::min(next, subscription.due);
  return next;
}

}  // namespace chimera::control
