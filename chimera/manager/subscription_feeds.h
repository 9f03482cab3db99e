// SPDX-License-Identifier: Apache-2.0
// The next notification of each subscription of the control protocol: status, events, values or the tap.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "chimera/control/rpc_response.h"
#include "chimera/manager/answer/tap_feed.h"

namespace chimera::manager {

/// Most events in one answer or notification.
inline constexpr std::size_t kEventsAtOnce = 1000;

/// The refusal of `machines`, which only chimera-web answers.
control::RpcResponse bench_alone();

/// Context: setup. The functions are those of control::ControlBackend with these names.
class SubscriptionFeeds {
 public:
  /// `state` outlives it.
  explicit SubscriptionFeeds(ManagerState& state) : state_(state) {}

  control::RpcResponse open(std::uint64_t subscription, const Json& parameters);
  void close(std::uint64_t subscription) { feeds_.erase(subscription); }
  std::shared_ptr<control::Pieces> pull_pieces(std::uint64_t subscription);
  std::shared_ptr<const Json> pull(std::uint64_t subscription);

 private:
  struct Feed {
    enum class To : std::uint8_t { kStatus, kEvents, kValues, kTap };
    To to = To::kStatus;
    std::uint64_t next = 0;             // event
    std::vector<VariableId> variables;  // values
    std::unique_ptr<TapFeed> tap;
    std::deque<std::shared_ptr<const Json>> waiting;  // of the tap
  };
  std::shared_ptr<const Json> pull_events(Feed& feed) const;
  std::shared_ptr<const Json> pull_tap(Feed& feed) const;

  ManagerState& state_;
  std::map<std::uint64_t, Feed> feeds_;
};

}  // namespace chimera::manager
