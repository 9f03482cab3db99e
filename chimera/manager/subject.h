// SPDX-License-Identifier: Apache-2.0
// What the door opens to: every method and subscription of the control protocol, over the manager's world.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "chimera/control/subject.h"
#include "chimera/manager/driver.h"
#include "chimera/manager/questions.h"
#include "chimera/manager/tap_feed.h"

namespace chimera::manager {

/// Context: setup.
class Subject final : public control::Subject {
 public:
  /// `driver` outlives it.
  /// So does `questions`; null: analyses are made here and now.
  explicit Subject(Driver& driver, Questions* questions = nullptr) : driver_(driver), questions_(questions) {}

  void call(const control::MethodRule& method, const control::Json& parameters, const control::Caller& caller,
            control::Reply reply) override;
  void forget(std::uint64_t session) override {
    if (questions_ != nullptr) questions_->forget(session);
  }
  control::Answer open(std::uint64_t subscription, const control::Json& parameters) override;
  void close(std::uint64_t subscription) override { subscriptions_.erase(subscription); }
  std::shared_ptr<const control::Json> pull(std::uint64_t subscription) override;

 private:
  struct Subscription {
    enum class To : std::uint8_t { kStatus, kEvents, kValues, kTap };
    To to = To::kStatus;
    std::uint64_t next = 0;             // event
    std::vector<VariableId> variables;  // values
    std::unique_ptr<TapFeed> tap;
    std::deque<std::shared_ptr<const control::Json>> waiting;  // of the tap
  };

  World& world() const noexcept { return driver_.world(); }
  control::Answer answer(std::string_view method, const control::Json& parameters, control::Role role);
  control::Answer hello(control::Role role) const;
  control::Answer get(const control::Json& parameters) const;
  control::Answer events(const control::Json& parameters) const;
  control::Answer ring(const control::Json& parameters);
  control::Answer why(const control::Json& parameters) const;
  control::Answer end(const control::Json& parameters);
  void signal(const control::Json& parameters, const control::Reply& reply);
  void analyse(Question::Kind kind, const control::Json& parameters, std::uint64_t session, control::Reply reply);
  control::Answer always(std::shared_ptr<const std::string>& text, control::Json (*make)(const World&)) const;
  control::Answer told(const subsystem::Answer& answer) const;
  control::Answer no_answer(RtpuId rtpu, const std::string& text) const;
  std::shared_ptr<const control::Json> pull_events(Subscription& subscription) const;
  std::shared_ptr<const control::Json> pull_tap(Subscription& subscription) const;

  Driver& driver_;
  Questions* questions_;
  std::shared_ptr<const std::string> library_, description_;  // what never changes, once somebody asked for it
  std::map<std::uint64_t, Subscription> subscriptions_;
};

}  // namespace chimera::manager
