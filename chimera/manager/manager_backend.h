// SPDX-License-Identifier: Apache-2.0
// What the door opens to: every method of the control protocol over the manager's world, one function each.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "chimera/control/control_backend.h"
#include "chimera/manager/manager_loop.h"
#include "chimera/manager/questions.h"
#include "chimera/manager/subscription_feeds.h"

namespace chimera::manager {

/// Context: setup.
class ManagerBackend final : public control::ControlBackend {
 public:
  /// `driver` outlives it.
  /// So does `questions`; null: analyses are made here and now.
  explicit ManagerBackend(ManagerLoop& driver, Questions* questions = nullptr)
      : driver_(driver), questions_(questions), feeds_(driver.world()) {}

  void call(const control::MethodRule& method, const control::Json& parameters, const control::Caller& caller,
            control::Reply reply) override;
  void forget(std::uint64_t connection) override {
    if (questions_ != nullptr) questions_->forget(connection);
  }
  control::RpcResponse open(std::uint64_t subscription, const control::Json& parameters) override {
    return feeds_.open(subscription, parameters);
  }
  void close(std::uint64_t subscription) override { feeds_.close(subscription); }
  std::shared_ptr<control::Pieces> pull_pieces(std::uint64_t subscription) override {
    return feeds_.pull_pieces(subscription);
  }
  std::shared_ptr<const control::Json> pull(std::uint64_t subscription) override { return feeds_.pull(subscription); }

 private:
  /// One call: its parameters have been checked by the row of its method.
  struct Request {
    const control::Json& parameters;
    const control::Caller& caller;
    const control::Reply& reply;
  };
  using Handler = void (ManagerBackend::*)(const Request& request);
  static Handler handler(control::MethodId method) noexcept;

  void hello(const Request& request);
  void status(const Request& request);
  void describe(const Request& request);
  void get(const Request& request);
  void profile(const Request& request);
  void events(const Request& request);
  void why(const Request& request);
  void check(const Request& request) { analyse(Question::Kind::kCheck, request); }
  void schedule(const Request& request) { analyse(Question::Kind::kSchedule, request); }
  void library(const Request& request);
  void signal(const Request& request);
  void ring(const Request& request);
  void set(const Request& request);
  void flag(const Request& request);
  void save(const Request& request);
  void end(const Request& request);
  void unknown(const Request& request);

  ManagerState& world() const noexcept { return driver_.world(); }
  void analyse(Question::Kind kind, const Request& request);
  control::RpcResponse always(std::shared_ptr<const std::string>& text,
                              control::Json (*make)(const ManagerState&)) const;

  ManagerLoop& driver_;
  Questions* questions_;
  SubscriptionFeeds feeds_;
  std::shared_ptr<const std::string> library_, description_;  // answers that never change, made at the first request
};

}  // namespace chimera::manager
