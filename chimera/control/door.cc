// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/door.h"

#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "chimera/config/nearest.h"
#include "chimera/platform/linux/owned_descriptor.h"

namespace chimera::control {
namespace {

constexpr std::uint64_t kListening = 0;                  // of epoll; sessions count from 1
constexpr int kAcceptAtOnce = 64;                        // a crowd of strangers must not stop the others
constexpr Nanoseconds kAcceptPause = milliseconds(100);  // when there is no descriptor left

bool watch(int epoll, int operation, int descriptor, std::uint32_t events, std::uint64_t number) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = number;
  return ::epoll_ctl(epoll, operation, descriptor, &event) == 0;
}

Answer too_fast(Nanoseconds wait) {
  return Answer::error(kTooFast, "too many requests", {{"retry_ms", (wait.count + 999'999) / 1'000'000}});
}

Answer no_role() {
  return Answer::error(kNoRight,
                       "you have no right here: you are neither the user of the subsystem nor in a group with a role",
                       {{"needs", "observe"}, {"has", "nothing"}});
}

Answer no_method(const std::string& name) {
  std::vector<std::string> names;
  for (const MethodRule& known : methods()) names.emplace_back(known.name);
  const std::string near = name.size() < 40 ? nearest(name, names) : "";
  Answer unknown = Answer::unknown("no method '" + name.substr(0, 40) + "'", "method", near);
  unknown.code = kNoMethod;
  return unknown;
}

}  // namespace

/// The one answer of a call that was handed to the subject: the first one counts, and if its reply is dropped without
/// any, the caller is told.
struct Door::Call {
  Call(Door& opened, Session& from, const Request& asked)
      : door(&opened), is_alive(opened.is_alive_), session(from.number()), request(asked) {
    ++from.open_calls;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() {
    if (!is_answered) take(Answer::error(kNoAnswer, "the subsystem gave no answer"));
  }
  void take(const Answer& said) {
    if (std::exchange(is_answered, true) || !*is_alive) return;
    const auto found = door->sessions_.find(session);
    if (found == door->sessions_.end()) return;
    --found->second->open_calls;
    door->answer(*found->second, request, said);
  }

  Door* door;
  std::shared_ptr<bool> is_alive;
  std::uint64_t session;
  Request request;
  bool is_answered = false;
};

Result<std::unique_ptr<Door>> Door::open(int listening, Subject& subject, uid_t owner, const RoleGroups& groups) {
  std::unique_ptr<Door> door(new Door(subject, owner, groups));
  door->listening_ = OwnedDescriptor(listening);
  door->epoll_ = OwnedDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  const bool is_watched = listening < 0 || watch(door->epoll_.fd, EPOLL_CTL_ADD, listening, EPOLLIN, kListening);
  if (door->epoll_.fd < 0 || !is_watched)
    return system_error(Message("the control socket cannot be watched"), "epoll");
  return door;
}

Door::~Door() { *is_alive_ = false; }

void Door::serve(Nanoseconds now) {
  now_ = now;
  has_more_ = false;
  if (now >= accepts_again_) {
    accepts_again_ = kNever;
    watch(epoll_.fd, EPOLL_CTL_MOD, listening_.fd, EPOLLIN, kListening);
  }
  epoll_event events[kMaxConnections + 1];
  const int n = ::epoll_wait(epoll_.fd, events, static_cast<int>(std::size(events)), 0);
  for (int i = 0; i < n; ++i) {
    const std::uint64_t number = events[i].data.u64;  // a copy: the event itself is packed
    const auto found = sessions_.find(number);
    if (number == kListening) accept(now);
    if (found == sessions_.end() || (events[i].events & (EPOLLIN | EPOLLHUP | EPOLLERR)) == 0) continue;
    found->second->receive();
    if ((events[i].events & (EPOLLHUP | EPOLLERR)) != 0) found->second->is_gone = true;
  }
  for (const auto& [number, session] : sessions_) read(*session, now);
  subscriptions_.notify([this](std::uint64_t number) -> Session& { return *sessions_.at(number); }, now);
  settle(now);
}

bool Door::may_enter(const PeerIdentity& peer) const {
  if (sessions_.size() >= kMaxConnections) return false;
  const auto is_same = [&](const auto& one) { return one.second->peer().user == peer.user; };
  return std::count_if(sessions_.begin(), sessions_.end(), is_same) < static_cast<long>(kMaxConnectionsOfUser);
}

void Door::accept(Nanoseconds now) {
  for (int n = 0; n < kAcceptAtOnce; ++n) {
    const int connected = ::accept4(listening_.fd, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (connected >= 0) {
      enter(OwnedDescriptor(connected), identify(connected, owner_, groups_), now);
    } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      accepts_again_ = now + kAcceptPause;  // the socket stays readable: not to be woken by it all the time
      watch(epoll_.fd, EPOLL_CTL_MOD, listening_.fd, 0, kListening);
      return;
    } else if (errno != EINTR && errno != ECONNABORTED) {
      return;
    }
  }
}

void Door::enter(OwnedDescriptor connected, const PeerIdentity& peer, Nanoseconds now) {
  auto session = std::make_unique<Session>(++last_session_, std::move(connected), peer, now);
  const bool enters = peer.role != Role::kNone && may_enter(peer);
  if (!enters) {
    const Answer why = peer.role == Role::kNone ? no_role() : Answer::error(kTooMany, "too many connections");
    session->say(answer_line(nullptr, why), now);
    (void)session->flush(now);
    return;
  }
  session->watched = EPOLLIN;
  if (!watch(epoll_.fd, EPOLL_CTL_ADD, session->descriptor(), EPOLLIN, session->number())) return;
  session->receive();  // whoever has only one question has asked it by now
  sessions_.emplace(session->number(), std::move(session));
}

void Door::read(Session& session, Nanoseconds now) {
  const auto is_open = [&] { return !session.is_closing() && session.has_room(); };
  std::string line;
  std::size_t bytes = 0;
  for (int n = 0; n < kLinesAtOnce && bytes < kMaxLine / 4 && is_open() && session.take_line(line); ++n) {
    take(session, line, now);
    bytes += line.size();
  }
  if (is_open() && session.has_line()) has_more_ = true;
}

void Door::take(Session& session, const std::string& line, Nanoseconds now) {
  const std::size_t pieces = 1 + std::min(line.size(), kMaxLine) / kLongLine;
  const bool may = session.requests.take(now, static_cast<std::int64_t>(pieces));
  const Answer refusal = may ? Answer{} : too_fast(session.requests.wait(now, static_cast<std::int64_t>(pieces)));
  const bool is_long = pieces > 1 && line.size() <= kMaxLine;
  if (!may && is_long) return session.say(answer_line(nullptr, refusal), now);  // its id is not worth the search
  const Request request = read_request(line);
  if (!request.refusal.is_good()) {
    session.say(answer_line(*request.id, request.refusal), now);
    if (request.must_close) session.close_after();
  } else if (!may) {
    answer(session, request, refusal);
  } else {
    carry_out(session, request, now);
  }
}

void Door::carry_out(Session& session, const Request& request, Nanoseconds now) {
  const MethodRule* rule = find_method(request.method);
  const Answer judged = judge(session, request, rule, now);
  if (!judged.is_good()) return answer(session, request, judged);
  if (request.method == "subscribe")
    return answer(session, request, subscriptions_.open(session.number(), *request.parameters, now));
  if (request.method == "unsubscribe")
    return answer(session, request, subscriptions_.close(session.number(), *request.parameters));
  auto call = std::make_shared<Call>(*this, session, request);
  subject_.call(*rule, *request.parameters, session.peer().role,
                [call = std::move(call)](const Answer& said) { call->take(said); });
}

Answer Door::judge(Session& session, const Request& request, const MethodRule* rule, Nanoseconds now) {
  if (rule == nullptr) return no_method(request.method);
  const Role has = session.peer().role;
  if (has < rule->role)
    return Answer::error(kNoRight,
                         std::string("'") + rule->name + "' needs the role " + role_name(rule->role) + ", you have " +
                             role_name(has),
                         {{"needs", role_name(rule->role)}, {"has", role_name(has)}});
  if (rule->is_act && !session.acts.take(now)) return too_fast(session.acts.wait(now));
  return check_parameters(*rule, *request.parameters);
}

void Door::answer(Session& session, const Request& request, const Answer& answer) {
  if (!request.wants_answer) return;
  session.say(answer_line(*request.id, answer), now_);
  has_more_ = true;  // outside of serve(): to be sent
}

/// What a peer said before it went is still carried out. One that says nothing more but listens is told what it asked
/// for and subscribed to.
bool Door::is_over(Session& session, Nanoseconds now) {
  if (session.is_gone && !session.has_line()) return true;
  const bool wants_more = session.open_calls > 0 || session.has_line() || subscriptions_.count_of(session.number()) > 0;
  if (session.has_ended() && !wants_more) session.close_after();
  return !session.flush(now);
}

void Door::settle(Nanoseconds now) {
  std::vector<std::uint64_t> over;
  bool waits = false;
  for (const auto& [number, session] : sessions_) {
    if (is_over(*session, now)) {
      over.push_back(number);
      continue;
    }
    const bool listens = session->has_room() && !session->is_closing() && !session->has_ended();
    const std::uint32_t wanted = (listens ? EPOLLIN : 0u) | (session->has_output() ? EPOLLOUT : 0u);
    if (wanted != session->watched) watch(epoll_.fd, EPOLL_CTL_MOD, session->descriptor(), wanted, number);
    session->watched = wanted;
    waits = waits || (!session->is_closing() && session->has_room() && session->has_line());
  }
  for (const std::uint64_t number : over) end(number);
  has_more_ = waits;
}

void Door::end(std::uint64_t session) {
  subscriptions_.end(session);
  sessions_.erase(session);
}

Nanoseconds Door::next_due() const noexcept {
  if (has_more_) return now_;
  Nanoseconds next = std::min(subscriptions_.next_due(), accepts_again_);
  for (const auto& [number, session] : sessions_) next = std::min(next, session->patience_ends());
  return next;
}

}  // namespace chimera::control
