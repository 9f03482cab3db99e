// SPDX-License-Identifier: Apache-2.0
// For tests: the rtpus of an application in virtual time, and a script of what happens to them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chimera/runtime/hosted/asked_sets.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"

namespace chimera::testing {

/// An act of kSwitch to that set, or of kDie of that rtpu.
inline ScriptAct act_at(Nanoseconds at, ScriptAct::Kind kind, std::uint32_t set_or_rtpu) {
  ScriptAct act;
  act.at = at;
  act.kind = kind;
  if (kind == ScriptAct::Kind::kDie) act.rtpu = RtpuId(set_or_rtpu);
  else act.set = set_or_rtpu;
  return act;
}

/// A context for each rtpu. One run.
class VirtualScene {
 public:
  VirtualScene(std::unique_ptr<TestApplication> application, std::vector<ScriptAct> acts, bool preemptive)
      : application_(std::move(application)), acts_(std::move(acts)),
        peers_(*VirtualPeers::create(application_->spec)) {
    for (std::uint32_t r = 0; r < application_->spec.rtpus.size(); ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers_.get();
      sets_.push_back(*HeapTaskSet::create(application_->spec, application_->components, place));
      peers_->join(RtpuId(r), *sets_.back());
    }
    RunOptions options;
    options.script = Script(acts_);
    options.asked = &asked_.emplace(application_->spec);
    VirtualOptions how;
    how.preemptive = preemptive;
    rtpus_ = std::make_unique<VirtualRtpus>(*peers_, options, how);
  }

  /// Runs for `duration` from the start on.
  void run(Nanoseconds duration) {
    EXPECT_TRUE(rtpus_->start());
    EXPECT_EQ(rtpus_->run(duration), RunEnd::kTime);
  }

  const AskedSets& asked() const { return *asked_; }
  VirtualPeers& peers() { return *peers_; }
  VirtualRtpus& rtpus() { return *rtpus_; }
  TaskSet& set(std::uint32_t rtpu) { return *sets_[rtpu]; }
  std::span<const SwitchReceipt> receipts() { return rtpus_->receipts().all(); }
  State state(TaskId task) const { return peers_->state(task); }
  /// These tasks are ON, and no others.
  bool are_on(const std::vector<TaskId>& tasks) const {
    for (std::uint32_t t = 0; t < application_->tasks.size(); ++t)
      if ((state(TaskId(t)) == State::kOn) != (std::ranges::count(tasks, TaskId(t)) != 0)) return false;
    return true;
  }
  /// Cycles that were late or not run, of all tasks.
  std::uint64_t lost() const {
    std::uint64_t n = 0;
    for (const auto& set : sets_)
      for (const Task& task : set->tasks()) n += task.profile.dropped + task.profile.missed;
    return n;
  }

 private:
  std::unique_ptr<TestApplication> application_;
  std::vector<ScriptAct> acts_;
  std::optional<AskedSets> asked_;
  std::unique_ptr<VirtualPeers> peers_;
  std::vector<std::unique_ptr<HeapTaskSet>> sets_;
  std::unique_ptr<VirtualRtpus> rtpus_;
};

}  // namespace chimera::testing
