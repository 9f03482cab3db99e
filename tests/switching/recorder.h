// SPDX-License-Identifier: Apache-2.0
// Records a switch as events of the model tests/models/switch.pml. It reads the page and the blocks that the rtpus
// share, and not the private state of an rtpu, before and after each call of an rtpu to its peers.
#pragma once

#include <string>
#include <vector>

#include "chimera/rtpu/testing/test_rtpus.h"

namespace chimera::switching_trial {

class Recorder {
 public:
  explicit Recorder(const testing::TestRtpus& rtpus) : rtpus_(rtpus), progress_(rtpus.n) {}

  /// "NAME WHO" each; who: the rtpu, or the number of rtpus for the manager.
  const std::vector<std::string>& events() const noexcept { return events_; }
  void add(const char* what, std::uint32_t who) { events_.push_back(std::string(what) + " " + std::to_string(who)); }
  /// Records the changes of the shared words since the last call; `who` has changed them.
  void look(std::uint32_t who) {
    const SwitchPage& page = rtpus_.decision.switching;
    const PlanWord plan = PlanWord::of(page.plan.load());
    const TurnWord turn = TurnWord::of(page.turn.load());
    if (plan.number != plan_.number) {
      add("prepared", who);
      plan_ = {plan.number, SwitchPhase::kPrepared, 0};
      turn_ = {turn.number, 0, static_cast<std::uint16_t>((1u << rtpus_.n) - 1)};
    }
    for (; turn_.run < turn.run; ++turn_.run) add("armed", who);
    const bool is_past = plan.phase == SwitchPhase::kProposed || plan.phase == SwitchPhase::kCommitted;
    if (plan_.phase == SwitchPhase::kPrepared && is_past) add("proposed", who);
    for (std::uint32_t rtpu = 0; rtpu < rtpus_.n; ++rtpu)
      if (((turn_.missing & ~turn.missing) >> rtpu & 1u) != 0) add("agreed", rtpu);
    if (plan.phase != plan_.phase && plan.phase == SwitchPhase::kCommitted) add("committed", who);
    if (plan.phase != plan_.phase && plan.phase == SwitchPhase::kAborted) add("aborted", who);
    plan_ = plan;
    turn_ = turn;
    for (std::uint32_t rtpu = 0; rtpu < rtpus_.n; ++rtpu) look_at(rtpu);
  }

 private:
  struct Progress {
    std::uint32_t adopted = 0, over = 0;
  };
  // An rtpu that finds the plan aborted adopts nothing.
  void look_at(std::uint32_t rtpu) {
    const SwitchProgress& words = rtpus_.rtpus[rtpu]->segment.block.head().switching;
    const Progress now{words.adopted.load(), words.over.load()};
    Progress& before = progress_[rtpu];
    const bool was_aborted = plan_.phase == SwitchPhase::kAborted;
    if (now.adopted != before.adopted && !was_aborted) add("adopted", rtpu);
    if (now.over != before.over) add("over", rtpu);
    before = now;
  }

  const testing::TestRtpus& rtpus_;
  PlanWord plan_;
  TurnWord turn_;
  std::vector<Progress> progress_;
  std::vector<std::string> events_;
};

}  // namespace chimera::switching_trial
