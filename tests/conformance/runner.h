// SPDX-License-Identifier: Apache-2.0
// The executors behind one interface, so that one suite runs over all of them, and the records on their taps.
#pragma once

#include <memory>
#include <vector>

#include "chimera/platform/clock.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/asked_sets.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/hosted/refusal_text.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/virtual_executor.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {

/// Computing on the virtual twin of the clock: the clock steps.
class TwinClock final : public JobClock {
 public:
  explicit TwinClock(VirtualClock& clock) noexcept : clock_(clock) {}
  Nanoseconds now() noexcept override { return clock_.now(); }
  void spend(Nanoseconds time) noexcept override { clock_.advance(time); }

 private:
  VirtualClock& clock_;
};

enum class Kind { kExecutiveOnTwin, kVirtual, kPreemptive };

inline const char* kind_name(Kind kind) {
  return kind == Kind::kExecutiveOnTwin ? "executive" : kind == Kind::kVirtual ? "virtual" : "preemptive";
}

/// For suites over all executors of one context.
inline const auto kEachExecutor = ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual, Kind::kPreemptive);
inline std::string name_of_kind(const ::testing::TestParamInfo<Kind>& one) { return kind_name(one.param); }

/// For suites over policies.
inline std::string name_of(const ::testing::TestParamInfo<Policy>& one) {
  const char* const names[] = {"Rm", "Edf", "Llf", "Muf", "MufLaxity"};
  return names[static_cast<int>(one.param)];
}

/// A tap and what came to it.
class Listened {
 public:
  Tap* tap() { return &tap_; }
  /// The records since the last call.
  std::vector<TapRecord> records() {
    std::vector<TapRecord> all(kTapRecords);
    all.resize(reader_.read(all));
    EXPECT_EQ(reader_.lost(), 0u);
    return all;
  }

 private:
  std::unique_ptr<TapRing> ring_ = std::make_unique<TapRing>();
  Tap tap_{*ring_};
  TapReader reader_{*ring_};
};

/// One run of one application on one executor.
class Runner {
 public:
  Runner(TaskSet& set, Kind kind, Policy policy = Policy::kEdf, std::span<const ScriptAct> acts = {},
      const VirtualOptions& how = {})
      : set_(set), job_clock_(clock_), asked_(set.spec()) {
    RunOptions options;
    options.asked = &asked_;
    options.policy = policy;
    options.script = Script(acts);
    options.tap = listened_.tap();
    VirtualOptions virtual_options = how;
    virtual_options.preemptive = kind == Kind::kPreemptive;
    if (kind == Kind::kExecutiveOnTwin) executive_ = std::make_unique<Executive>(set, clock_, job_clock_, options);
    else virtual_ = std::make_unique<VirtualExecutor>(set, options, virtual_options);
  }

  Result<void> start() { return executive_ ? start_result(set_, executive_->start()) : virtual_->start(); }
  RunEnd run(Nanoseconds duration) { return executive_ ? executive_->run(duration) : virtual_->run(duration); }
  const AskedSets& asked() const { return asked_; }
  std::span<const RefusedSignal> refused() {
    return executive_ ? executive_->refused() : virtual_->refused();
  }
  void shut_down() { executive_ ? executive_->shut_down() : virtual_->shut_down(); }

  std::span<const SwitchReceipt> receipts() { return kept().all(); }
  const SwitchReceipts& kept() { return executive_ ? executive_->receipts() : virtual_->receipts(); }
  /// The records since the last call.
  std::vector<TapRecord> records() { return listened_.records(); }

 private:
  TaskSet& set_;
  Listened listened_;
  VirtualClock clock_;
  TwinClock job_clock_;
  AskedSets asked_;
  std::unique_ptr<Executive> executive_;
  std::unique_ptr<VirtualExecutor> virtual_;
};

/// A suite over all executors of one context. Its tests run an application of the suite with acts of a script.
class OneContext : public ::testing::TestWithParam<Kind> {
 protected:
  /// Adds the tasks of the application, their order and their sets.
  virtual void describe(testing::TestApplication& app) = 0;

  void build(const std::vector<ScriptAct>& acts = {}) {
    acts_ = acts;
    runner_.reset();
    set_.reset();
    app_ = std::make_unique<testing::TestApplication>();
    describe(*app_);
    set_ = *HeapTaskSet::create(app_->spec, app_->components);
    runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
  }
  /// Starts what was built, and answers the receipts.
  std::span<const SwitchReceipt> run(Nanoseconds duration) {
    EXPECT_TRUE(runner_->start());
    EXPECT_EQ(runner_->run(duration), end_);
    return runner_->receipts();
  }
  std::span<const SwitchReceipt> go(Nanoseconds duration, const std::vector<ScriptAct>& acts = {}) {
    build(acts);
    return run(duration);
  }
  static ScriptAct to(std::uint32_t set, Nanoseconds at) {
    ScriptAct act;
    act.at = at;
    act.kind = ScriptAct::Kind::kSwitch;
    act.set = set;
    return act;
  }
  static ScriptAct signal(Nanoseconds at, Signal signal, TaskId task) {
    return {at, ScriptAct::Kind::kSignal, signal, task};
  }
  const Task& task(TaskId id) const { return set_->tasks()[id.index]; }
  chimera::State state(TaskId id) const { return task(id).state; }
  bool is_on(TaskId id) const { return state(id) == chimera::State::kOn; }

  RunEnd end_ = RunEnd::kTime;
  std::vector<ScriptAct> acts_;
  std::unique_ptr<testing::TestApplication> app_;
  std::unique_ptr<HeapTaskSet> set_;
  std::unique_ptr<Runner> runner_;
};

}  // namespace chimera::toy
