// SPDX-License-Identifier: Apache-2.0
// Runs a random loop of tasks on one to three rtpus in virtual time through a random script of switches that exchange
// tasks of the loop. Each task writes the instant of its cycle, so that the age of what another one reads is known.
#include <algorithm>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"
#include "tests/switching/trial.h"

namespace chimera::switching_trial {
namespace {

constexpr std::uint32_t kMostLinks = 4, kAlternatives = 2;
// A period, and the jobs of a whole rtpu.
constexpr double kOldestWhileArming = 2.0 + 0.5;
// The arming, the time until the change, and the first cycle come on top.
constexpr double kOldest = 8;

/// The ages in ms of what was read.
struct Ages {
  double while_arming = 0, in_cycle = 0;
};
Ages ages;

double age(Cycle c, double written) { return static_cast<double>(c.now().count) / 1e6 - written; }

struct LinkOfLoop {
  In<double> x{"x", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void on(Cycle c) {
    if (c.now() > milliseconds(10)) ages.while_arming = std::max(ages.while_arming, age(c, *x));
    *y = *x;
  }
  void cycle(Cycle c) {
    if (c.now() > milliseconds(10)) ages.in_cycle = std::max(ages.in_cycle, age(c, *x));
    *y = static_cast<double>(c.now().count) / 1e6;
  }
  void off(Cycle) { *y = -1e6; }
};

/// Task a of link l has number l * kAlternatives + a, reads variable l and writes variable l + 1, the last one 0.
class LoopRun {
 public:
  LoopRun(std::uint64_t seed, std::uint32_t n_switches) : chance_(seed) {
    n_links_ = static_cast<std::uint32_t>(2 + chance_.below(kMostLinks - 1));
    const auto n_rtpus = static_cast<std::uint32_t>(1 + chance_.below(3));
    const char* const names[] = {"first", "second", "third"};
    app_.rtpus.clear();
    for (std::uint32_t r = 0; r < n_rtpus; ++r) {
      app_.rtpus.push_back({names[r], r, Policy::kEdf});
      app_.rtpus.back().preemptive = chance_.below(2) == 0;
    }
    for (std::uint32_t t = 0; t < n_links_ * kAlternatives; ++t) add_task(t);
    for (std::uint32_t s = 0; s < 1u << n_links_; ++s) add_set(s);
    for (std::uint32_t s = 0; s < sets_.size(); ++s) named_.push_back({set_names_[s], sets_[s]});
    app_.make(sets_[0], false);
    app_.spec.sets = named_;
    end_ = milliseconds(20);
    for (std::uint32_t i = 0; i < n_switches; ++i) {
      ScriptAct act;
      act.at = end_;
      act.kind = ScriptAct::Kind::kSwitch;
      act.set = static_cast<std::uint32_t>(chance_.below(sets_.size()));
      acts_.push_back(act);
      end_ += milliseconds(20) + microseconds(static_cast<std::int64_t>(chance_.below(20'000)));
    }
  }

  Tally go() {
    ages = {};
    const auto peers = *VirtualPeers::create(app_.spec);
    std::vector<std::unique_ptr<HeapTaskSet>> contexts;
    for (std::uint32_t r = 0; r < app_.rtpus.size(); ++r) {
      const auto is_its = [r](const TaskSpec& task) { return task.rtpu.index == r; };
      if (std::ranges::none_of(app_.tasks, is_its)) continue;
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers.get();
      place.preemptive = app_.rtpus[r].preemptive;
      contexts.push_back(*HeapTaskSet::create(app_.spec, app_.components, place));
      peers->join(RtpuId(r), *contexts.back());
    }
    RunOptions options;
    options.script = Script(acts_);
    VirtualRtpus rtpus(*peers, options, {});
    if (const auto started = rtpus.start(); !started) fail(started.error().message.c_str());
    else if (rtpus.run(end_) != RunEnd::kTime) fail("the run does not come to its end");
    judge(rtpus.receipts().all());
    return tally_;
  }

 private:
  void add_task(std::uint32_t number) {
    const std::uint32_t link = number / kAlternatives;
    const std::string& name = names_.emplace_back("task" + std::to_string(number));
    const auto period = milliseconds(static_cast<std::int64_t>(1 + chance_.below(2)));
    TaskSpec& task = app_.add(name.c_str(), testing::component<LinkOfLoop>("link_of_loop"), period);
    task.rtpu = RtpuId(chance_.below(app_.rtpus.size()));
    task.budget = microseconds(30);
    task.offset = microseconds(static_cast<std::int64_t>(chance_.below(2) * 300));
    app_.link(number, 0, variable(link));
    app_.link(number, 1, variable((link + 1) % n_links_));
  }
  /// Bit l of `choice`: which alternative of link l. The order is that of the loop from a random link on.
  void add_set(std::uint32_t choice) {
    std::vector<TaskId>& set = sets_.emplace_back();
    for (std::uint32_t l = 0; l < n_links_; ++l) set.push_back(TaskId(l * kAlternatives + (choice >> l & 1u)));
    set_names_.push_back("set" + std::to_string(choice));
  }
  static const char* variable(std::uint32_t number) {
    static const char* const names[kMostLinks] = {"v0", "v1", "v2", "v3"};
    return names[number];
  }
  void fail(const std::string& what) {
    if (tally_.failure.empty()) tally_.failure = what;
  }
  void judge(std::span<const SwitchReceipt> receipts) {
    tally_.switches = acts_.size();
    if (receipts.size() != acts_.size()) fail("a switch has no receipt");
    for (const SwitchReceipt& receipt : receipts) {
      if (receipt.end == SwitchEnd::kNothingToDo) continue;
      const std::string which = "switch " + std::to_string(receipt.number);
      if (receipt.end != SwitchEnd::kDone || receipt.way.slow != 0) fail(which + " of a loop is not made, or slow");
      else ++tally_.done;
      for (const TaskPart& part : receipt.tasks)
        if (part.lost != 0) fail(which + " of a loop: a cycle is lost");
    }
    if (ages.while_arming > kOldestWhileArming)
      fail("a value of " + std::to_string(ages.while_arming) + " ms ago was read while arming in a loop");
    if (ages.in_cycle > kOldest) fail("a step in a loop: a value of " + std::to_string(ages.in_cycle) + " ms ago");
  }

  simulated::Chance chance_;
  testing::TestApplication app_;
  std::uint32_t n_links_ = 0;
  std::deque<std::string> names_;
  std::deque<std::string> set_names_;
  std::deque<std::vector<TaskId>> sets_;
  std::vector<NamedSet> named_;
  std::vector<ScriptAct> acts_;
  Nanoseconds end_;
  Tally tally_;
};

}  // namespace

Tally run_loop_trial(std::uint64_t seed, std::uint32_t n_switches) {
  return std::make_unique<LoopRun>(seed, n_switches)->go();
}

}  // namespace chimera::switching_trial
