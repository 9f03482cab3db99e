// SPDX-License-Identifier: Apache-2.0
// The methods of the control protocol behind ControlServer. ReadMethods answers those that change nothing; each other
// one is a function here. The answer to a signal is the answer of the step function in the words of the protocol.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "chimera/control/control_backend.h"
#include "chimera/manager/answer/questions.h"
#include "chimera/manager/manager_loop.h"
#include "chimera/manager/read_methods.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/subscription_feeds.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// The states of the tasks before and after, or the refusal with its kind, place and remedy. Context: setup.
control::RpcResponse signal_answer(const ManagerState& state, const subsystem::CommandAnswer& answer);

/// The receipt of a switch, or the reason why it did not begin. Context: setup.
control::RpcResponse switch_answer(const ManagerState& state, const SwitchOutcome& outcome);

/// The results of a drill, by task. Context: setup.
Json drill_json(const ManagerState& state, const DrillOutcome& outcome);
/// The plan of a switch now, or the reason why it would be refused. Context: setup.
Json plan_json(const ManagerState& state, const ForeseenSwitch& foreseen);

/// The last `n` receipts, and the state of their file. Context: setup.
control::RpcResponse receipts_answer(const ReceiptArchive& archive, std::size_t n);

/// A request for a switch: the tasks that are to be ON, and the lists that they were worked out from.
struct WantedTasks {
  TaskBits target;
  TaskLists lists;  ///< empty where a configuration was named
};

/// Context: setup.
class ManagerBackend final : public control::ControlBackend {
 public:
  /// `loop` and `questions` outlive it. If `questions` is null, analyses are made in the call.
  explicit ManagerBackend(ManagerLoop& loop, Questions* questions = nullptr)
      : loop_(loop), questions_(questions), reads_(loop.state()), feeds_(loop.state()) {}

  void call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
            control::Reply reply) override;
  void forget(std::uint64_t connection) override {
    if (questions_ != nullptr) questions_->forget(connection);
  }
  control::RpcResponse open(std::uint64_t subscription, const Json& parameters) override {
    return feeds_.open(subscription, parameters);
  }
  void close(std::uint64_t subscription) override { feeds_.close(subscription); }
  std::shared_ptr<control::Pieces> pull_pieces(std::uint64_t subscription) override {
    return feeds_.pull_pieces(subscription);
  }
  std::shared_ptr<const Json> pull(std::uint64_t subscription) override { return feeds_.pull(subscription); }

 private:
  /// One call: the row of its method has checked its parameters.
  struct Request {
    const Json& parameters;
    const control::Caller& caller;
    const control::Reply& reply;
  };
  void signal(const Request& request);
  void ring(const Request& request);
  void receipts(const Request& request);
  void plan(const Request& request);
  void switch_to(const Request& request);
  void cancel(const Request& request);
  void drill(const Request& request);
  void end(const Request& request);

  ManagerState& state() const noexcept { return loop_.state(); }
  std::optional<WantedTasks> wanted(const Request& request) const;
  void analyse(Question::Kind kind, const Request& request);

  ManagerLoop& loop_;
  Questions* questions_;
  ReadMethods reads_;
  SubscriptionFeeds feeds_;
};

}  // namespace chimera::manager
