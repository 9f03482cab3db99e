// SPDX-License-Identifier: Apache-2.0
// Opens a feed for each subscription, and makes its next notification on request.
#include "chimera/manager/subscription_feeds.h"

#include <algorithm>

#include "chimera/control/methods.h"
#include "chimera/manager/act/operator_acts.h"
#include "chimera/manager/answer/large_readings.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/answer/value_json.h"
#include "chimera/text/json.h"

namespace chimera::manager {

using control::RpcResponse;

namespace {

std::shared_ptr<const Json> shared(Json json) { return std::make_shared<const Json>(std::move(json)); }

}  // namespace

RpcResponse bench_alone() {
  return RpcResponse::refused("bench", "the server of the page answers this, not a subsystem", "",
                              "ask the server of the page: `chimera web`");
}

RpcResponse SubscriptionFeeds::open(std::uint64_t subscription, const Json& parameters) {
  using To = Feed::To;
  const std::string to = parameters.at("to").as_string();
  if (to == "machines" || to == "draft") return bench_alone();
  const auto names = control::texts(parameters, "variables");
  auto variables = variables_named(state_, names);
  if (const auto* refused = std::get_if<RpcResponse>(&variables)) return *refused;
  Feed made;
  made.to = to == "status" ? To::kStatus : to == "events" ? To::kEvents : to == "values" ? To::kValues : To::kTap;
  if (made.to == To::kEvents) made.next = control::number(parameters, "since", state_.log.last() + 1);
  if (made.to == To::kValues) made.variables = std::get<0>(std::move(variables));
  else if (made.to == To::kTap)
    made.tap = std::make_unique<TapFeed>(
        state_, names.empty() ? std::vector<VariableId>() : std::get<0>(std::move(variables)),
        control::number(parameters, "since", 1) == 0);
  feeds_[subscription] = std::move(made);
  return RpcResponse{};
}

std::shared_ptr<control::Pieces> SubscriptionFeeds::pull_pieces(std::uint64_t subscription) {
  const Feed& feed = feeds_.at(subscription);
  if (feed.to != Feed::To::kValues || bytes_of(state_, feed.variables) <= kLargeReadings) return nullptr;
  const std::string begin = R"({"at_ns":)" + std::to_string(now().count) + R"(,"subscription":)" +
                            std::to_string(subscription) + R"(,"values":)";
  return std::make_shared<LargeReadings>(state_, feed.variables, begin, "}");
}

std::shared_ptr<const Json> SubscriptionFeeds::pull(std::uint64_t subscription) {
  Feed& feed = feeds_.at(subscription);
  const Nanoseconds at = now();
  switch (feed.to) {
    case Feed::To::kStatus:
      return shared(status_json(state_, at));
    case Feed::To::kValues:
      return shared({{"at_ns", at.count}, {"values", readings_json(state_, feed.variables, at)}});
    case Feed::To::kEvents:
      return pull_events(feed);
    case Feed::To::kTap:
      break;
  }
  return pull_tap(feed);
}

std::shared_ptr<const Json> SubscriptionFeeds::pull_events(Feed& feed) const {
  const EventLog& log = state_.log;
  const std::uint64_t from = std::max<std::uint64_t>(feed.next, 1);
  if (from > log.last()) return nullptr;
  Json found = events_json(state_, from, kEventsAtOnce);
  const std::uint64_t lost = log.first() > from ? log.first() - from : 0;
  feed.next = std::max(from, log.first()) + found["events"].size();
  return shared({{"events", std::move(found["events"])}, {"lost", lost}});
}

std::shared_ptr<const Json> SubscriptionFeeds::pull_tap(Feed& feed) const {
  // Reads the tap again only when all messages have been sent. Rows that a slow client leaves in the ring are
  // overwritten and counted as lost.
  if (feed.waiting.empty()) feed.tap->pump([&](Json message) { feed.waiting.push_back(shared(std::move(message))); });
  if (feed.waiting.empty()) return nullptr;
  auto message = std::move(feed.waiting.front());
  feed.waiting.pop_front();
  return message;
}

}  // namespace chimera::manager
