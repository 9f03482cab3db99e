// SPDX-License-Identifier: Apache-2.0
// Keeps the subscriptions of connections and sends what is due.
#include "chimera/control/subscriptions.h"

#include <algorithm>

#include "chimera/control/request.h"
#include "chimera/control/turn.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

constexpr Nanoseconds kLookAtNews = milliseconds(10);  // for what has no period
constexpr int kNewsAtOnce = 64;                        // messages of one subscription in one turn

}  // namespace

RpcResponse Subscriptions::open(std::uint64_t connection, const Json& parameters, Nanoseconds now) {
  if (count_of(connection) >= kMaxSubscriptions)
    return RpcResponse::error(kBadParameters, "this connection has 32 subscriptions already, and no more are allowed",
                              {{"where", "to"}});
  const std::uint64_t number = ++last_;
  RpcResponse opened = backend_.open(number, parameters);
  if (!opened.is_good()) return opened;
  const std::string to = parameters.at("to").as_string();
  const bool skips = to != "events" && to != "tap";
  const Nanoseconds period = skips ? milliseconds(whole_at(parameters, "period_ms", 100)) : kLookAtNews;
  all_[number] = {connection, to, period, skips, now};
  return RpcResponse::good({{"subscription", number}});
}

RpcResponse Subscriptions::close(std::uint64_t connection, const Json& parameters) {
  const auto number = parameters.at("subscription").as_uint64();
  const auto found = all_.find(number);
  if (found == all_.end() || found->second.connection != connection)
    return RpcResponse::unknown("no subscription " + std::to_string(number), "subscription", "");
  backend_.close(number);
  all_.erase(found);
  return RpcResponse::good(Json::object());
}

void Subscriptions::end(std::uint64_t connection) {
  std::erase_if(all_, [&](const auto& one) {
    if (one.second.connection != connection) return false;
    backend_.close(one.first);
    return true;
  });
}

std::size_t Subscriptions::count_of(std::uint64_t connection) const noexcept {
  const auto is_of = [connection](const auto& one) { return one.second.connection == connection; };
  return static_cast<std::size_t>(std::count_if(all_.begin(), all_.end(), is_of));
}

void Subscriptions::notify(const std::function<Connection&(std::uint64_t)>& connection_of, Nanoseconds now) {
  const Turn turn;
  auto at = all_.upper_bound(last_told_);  // subscriptions that the last turn did not reach come first
  for (std::size_t n = all_.size(); n > 0 && !turn.is_over(); --n, ++at) {
    if (at == all_.end()) at = all_.begin();
    auto& [number, one] = *at;
    if (now < one.due) continue;
    last_told_ = number;
    one.due = one.due + one.period > now ? one.due + one.period : now + one.period;  // what was missed stays so
    Connection& connection = connection_of(one.connection);
    if (connection.is_closing()) continue;
    if (one.skips) (void)connection.flush(now);  // an answer that can go at once is no reason to skip
    const auto may = [&connection, skips = one.skips] {
      return skips ? !connection.has_output() : connection.has_room();
    };
    bool has_more = false;
    for (int told = 0; told < (one.skips ? 1 : kNewsAtOnce) && may() && (told == 0 || !turn.is_over()); ++told) {
      if (auto pieces = backend_.pull_pieces(number); pieces != nullptr) {
        connection.queue_in_pieces(note_begin(one.to), std::move(pieces), kNoteEnd, now);
        continue;
      }
      const auto news = backend_.pull(number);
      has_more = news != nullptr;
      if (!has_more) break;
      connection.queue(note_line(one.to, number, *news), now);
    }
    if (has_more && !one.skips && turn.is_over()) one.due = now;  // there is more, and only no time for it
  }
}

Nanoseconds Subscriptions::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const auto& [number, one] : all_) next = std::min(next, one.due);
  return next;
}

}  // namespace chimera::control
