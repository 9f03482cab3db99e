// SPDX-License-Identifier: Apache-2.0
// For tests: the state of a manager of the application of fake_subsystem.h without messages of any rtpu. There is no
// process, no thread, and no segment but its own.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager {

class LoneState {
 public:
  LoneState() {
    Bundle bundle = fake_bundle();
    configuration_ = verify(bundle).configuration;
    EXPECT_TRUE(configuration_);
    keeper_.n_rtpus = static_cast<std::uint32_t>(spec().rtpus.size());
    Peers peers = *Peers::create(spec());
    OwnSegment own = *OwnSegment::make(peers, 1, nullptr, now());
    state_ = std::make_unique<ManagerState>(std::move(bundle), std::move(peers), std::move(own), page_, keeper_);
  }

  ManagerState& state() { return *state_; }
  const ApplicationSpec& spec() const { return configuration_->spec(); }
  TaskId task(std::string_view name) const {
    for (std::size_t t = 0; t < spec().tasks.size(); ++t)
      if (spec().tasks[t].name == name) return TaskId(t);
    ADD_FAILURE() << "no task " << name;
    return TaskId(std::size_t{0});
  }
  /// "KIND: TEXT" of each event after number `last`, one a line.
  std::string told(std::uint64_t last = 0) const {
    std::string text;
    for (std::uint64_t n = std::max(last + 1, state_->log.first()); n <= state_->log.last(); ++n)
      text += state_->log.at(n).kind + ": " + state_->log.at(n).text + "\n";
    return text;
  }

 private:
  std::optional<Configuration> configuration_;
  DecisionPage page_;
  KeeperPage keeper_;
  std::unique_ptr<ManagerState> state_;
};

}  // namespace chimera::manager
