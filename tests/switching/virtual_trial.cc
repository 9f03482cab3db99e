// SPDX-License-Identifier: Apache-2.0
// Runs three rtpus in virtual time through a random script of switches, and judges what their readers saw.
#include <algorithm>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"
#include "tests/switching/trial.h"

namespace chimera::switching_trial {
namespace {

constexpr std::uint32_t kUnits = 3;

class VirtualRun {
 public:
  VirtualRun(std::uint64_t seed, std::uint32_t n_switches)
      : chance_(seed), application_(reset(chance_), static_cast<unsigned>(chance_.below(8))) {
    for (std::uint32_t i = 0; i < n_switches; ++i) {
      end_ += microseconds(static_cast<std::int64_t>(500 + chance_.below(8000)));
      ScriptAct act;
      act.at = end_;
      act.kind = ScriptAct::Kind::kSwitch;
      act.set = static_cast<std::uint32_t>(chance_.below(application_.sets.size()));
      acts_.push_back(act);
    }
    end_ += milliseconds(20);
    peers_ = *VirtualPeers::create(application_.app.spec);
    for (std::uint32_t r = 0; r < kUnits; ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers_.get();
      place.preemptive = application_.app.rtpus[r].preemptive;
      sets_.push_back(*HeapTaskSet::create(application_.app.spec, application_.app.components, place));
      peers_->join(RtpuId(r), *sets_.back());
    }
  }

  Tally go() {
    RunOptions options;
    options.script = Script(acts_);
    VirtualRtpus rtpus(*peers_, options, {});
    if (const auto started = rtpus.start(); !started) fail(started.error().message.c_str());
    else if (rtpus.run(end_) != RunEnd::kTime) fail("the run does not come to its end");
    judge(rtpus.receipts().all());
    return tally_;
  }

 private:
  static std::uint32_t reset(simulated::Chance& chance) {
    stage = {};
    stage.on_takes = microseconds(static_cast<std::int64_t>(chance.below(80)));
    stage.cycle_takes = microseconds(static_cast<std::int64_t>(chance.below(45)));
    return kUnits;
  }
  void fail(const std::string& what) {
    if (tally_.failure.empty()) tally_.failure = what;
  }
  void judge(std::span<const SwitchReceipt> receipts) {
    tally_.switches = acts_.size();
    if (receipts.size() != acts_.size()) fail("a switch has no receipt");
    readers_.begin(1);
    std::uint32_t number = 0, in_force = kFirst;
    for (const SwitchReceipt& receipt : receipts) {
      const std::string which = "switch " + std::to_string(++number);
      if (receipt.end == SwitchEnd::kAborted || receipt.why == NoSwitch::kNotSchedulable) fail(which + " is not made");
      if (receipt.end != SwitchEnd::kDone) continue;
      ++tally_.done;
      if (receipt.before != in_force) fail(which + " begins elsewhere");
      const TaskId producer = Application::producer(receipt.after);
      if (producer != Application::producer(in_force)) readers_.change(receipt.at, life_of(producer, receipt, which));
      in_force = receipt.after;
      for (const TaskPart& part : receipt.tasks)
        if (part.lost != 0) fail(which + ": a cycle is lost");
    }
    for (const Look& look : stage.looks) {
      ++tally_.looks;
      const Nanoseconds period = application_.app.tasks[look.reader.index].period;
      const std::string wrong = readers_.judge(look, period, [](std::uint16_t) { return 1; });
      if (!wrong.empty()) fail(wrong);
    }
    for (const auto& set : sets_)
      for (const Task& task : set->tasks())
        if (task.standing == Standing::kOwesOff) fail("a task is armed for nothing");
  }
  std::uint32_t life_of(TaskId producer, const SwitchReceipt& receipt, const std::string& which) {
    for (auto life = static_cast<std::uint32_t>(stage.lives.size() - 1); life > 0; --life) {
      const Life& one = stage.lives[life];
      if (one.task == producer && one.at >= receipt.asked && one.at <= receipt.at) return life;
    }
    fail(which + ": its producer was not armed");
    return 0;
  }

  simulated::Chance chance_;
  Application application_;
  std::vector<ScriptAct> acts_;
  Nanoseconds end_;
  std::unique_ptr<VirtualPeers> peers_;
  std::vector<std::unique_ptr<HeapTaskSet>> sets_;
  Readers readers_;
  Tally tally_;
};

}  // namespace

Tally run_virtual_trial(std::uint64_t seed, std::uint32_t n_switches) {
  return std::make_unique<VirtualRun>(seed, n_switches)->go();
}

}  // namespace chimera::switching_trial
