// SPDX-License-Identifier: Apache-2.0
// The executors behind one interface, so that one suite runs over all of them, and the records on their taps.
#pragma once

#include <memory>
#include <vector>

#include "chimera/platform/clock.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/asked_sets.h"
#include "chimera/runtime/hosted/refusal_text.h"
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

}  // namespace chimera::toy
