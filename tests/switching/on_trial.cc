// SPDX-License-Identifier: Apache-2.0
// Persons turn producers of one variable ON and OFF, create and kill them at any instant of fast and slow switches that
// wait, arm, change and undo, on one to three rtpus in virtual time. No task reads the variable: the
// illegal-configuration flag is up only in a slow switch, or while two of them are ON.
#include <algorithm>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"
#include "tests/switching/trial.h"

namespace chimera::switching_trial {
namespace {

constexpr std::uint32_t kMostRtpus = 3, kProducers = 5, kOnDevice = 3;  // the first three open no device

/// The run, as the witnesses see it.
struct Sight {
  std::array<TaskSet*, kMostRtpus> contexts{};
  std::uint32_t n_rtpus = 1;
  Nanoseconds two_at = kNever;
  std::uint64_t looks = 0;
};
Sight sight;

bool is_on(const Task& task) { return task.shown_state() == State::kOn; }

std::uint32_t n_producers_on() {
  std::uint32_t n = 0;
  for (std::uint32_t r = 0; r < sight.n_rtpus; ++r)
    for (const Task& task : sight.contexts[r]->tasks())
      n += sight.contexts[r]->is_mine(task.id) && task.id.index >= sight.n_rtpus && is_on(task);
  return n;
}

struct Witness {
  Out<double> phase{"phase", "1", initial = 0.0};
  void cycle(Cycle c) {
    *phase = static_cast<double>(c.count() % 40);
    ++sight.looks;
    if (c.illegal() && n_producers_on() > 1 && sight.two_at == kNever) sight.two_at = c.now();
  }
};

struct FreeProducer {
  Out<double> level{"level", "1", initial = 0.0};
  void on(Cycle c) { c.spend(microseconds(20)); }
  void cycle(Cycle) { *level = 1; }
};

struct DeviceProducer {
  Out<double> level{"level", "1", initial = 0.0};
  Resource device{"device"};
  void on(Cycle c) { c.spend(microseconds(20)); }
  void cycle(Cycle) { *level = 2; }
};

class OnRun {
 public:
  OnRun(std::uint64_t seed, std::uint32_t n_acts) : chance_(seed) {
    sight = {};
    sight.n_rtpus = static_cast<std::uint32_t>(1 + chance_.below(kMostRtpus));
    static const char* const rtpus[] = {"a", "b", "c"};
    static const char* const names[] = {"w0", "w1", "w2", "p0", "p1", "p2", "d3", "d4"};
    static const char* const phases[] = {"phase0", "phase1", "phase2"};
    app_.rtpus.clear();
    std::vector<TaskId> witnesses;
    for (std::uint32_t r = 0; r < sight.n_rtpus; ++r) {
      app_.rtpus.push_back({rtpus[r], r, Policy::kEdf});
      app_.rtpus.back().preemptive = chance_.below(2) == 0;
      add<Witness>(names[r], r, microseconds(100));
      app_.link(r, 0, phases[r]);
      witnesses.push_back(TaskId(r));
    }
    for (std::uint32_t p = 0; p < kProducers; ++p) {
      const auto rtpu = static_cast<std::uint32_t>(chance_.below(sight.n_rtpus));
      const char* const name = names[kMostRtpus + p];
      if (p < kOnDevice) add<FreeProducer>(name, rtpu, milliseconds(1));
      else add<DeviceProducer>(name, rtpu, milliseconds(1));
      if (p >= kOnDevice) app_.port(producer(p).index, 1).value = device_;
      sets_.push_back(witnesses);
      sets_.back().push_back(producer(p));
    }
    for (std::uint32_t p = 0; p < kProducers; ++p) named_.push_back({names[kMostRtpus + p], sets_[p]});
    app_.make(sets_[0], false);
    const VariableId phase(Variables(app_.spec).find(phases[chance_.below(sight.n_rtpus)]));
    for (NamedSet& set : named_) {
      const double limit = 10.0 + static_cast<double>(chance_.below(25));
      if (chance_.below(2) == 0) set.safe_when = {phase, 0, Relation::kMore, limit};
    }
    app_.spec.sets = named_;
    for (std::uint32_t i = 0; i < n_acts; ++i) acts_.push_back(act());
  }

  Tally go() {
    const auto peers = *VirtualPeers::create(app_.spec);
    std::vector<std::unique_ptr<HeapTaskSet>> contexts;
    for (std::uint32_t r = 0; r < sight.n_rtpus; ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers.get();
      place.preemptive = app_.rtpus[r].preemptive;
      contexts.push_back(*HeapTaskSet::create(app_.spec, app_.components, place));
      sight.contexts[r] = contexts.back().get();
      peers->join(RtpuId(r), *contexts.back());
    }
    RunOptions options;
    options.script = Script(acts_);
    VirtualRtpus rtpus(*peers, options, {});
    if (const auto started = rtpus.start(); !started) fail(started.error().message.c_str());
    else if (rtpus.run(now_ + milliseconds(20)) != RunEnd::kTime) fail("the run does not come to its end");
    if (sight.two_at != kNever) fail("two producers are ON at " + std::to_string(sight.two_at.count) + " ns");
    for (const SwitchReceipt& receipt : rtpus.receipts().all()) {
      ++tally_.switches;
      tally_.done += receipt.end == SwitchEnd::kDone;
      tally_.aborted += receipt.end == SwitchEnd::kAborted;
    }
    for (const RefusedSignal& refused : rtpus.refused()) tally_.signals += refused.why == Refusal::kSwitch;
    tally_.looks = sight.looks;
    return tally_;
  }

 private:
  static TaskId producer(std::uint32_t number) { return TaskId(sight.n_rtpus + number); }
  template <class T>
  void add(const char* name, std::uint32_t rtpu, Nanoseconds period) {
    TaskSpec& task = app_.add(name, testing::component<T>(name), period);
    task.rtpu = RtpuId(rtpu);
    task.budget = microseconds(10);
  }
  ScriptAct act() {
    now_ += microseconds(static_cast<std::int64_t>(1 + chance_.below(chance_.below(2) == 0 ? 300 : 4000)));
    ScriptAct next;
    next.at = now_;
    const std::uint64_t kind = chance_.below(20);
    next.kind = kind < 7 ? ScriptAct::Kind::kSwitch : ScriptAct::Kind::kSignal;
    next.signal = kind < 12 ? Signal::kOn : kind < 16 ? Signal::kOff : kind < 18 ? Signal::kSpawn : Signal::kKill;
    next.set = static_cast<std::uint32_t>(chance_.below(kProducers));
    next.task = producer(static_cast<std::uint32_t>(chance_.below(kProducers)));
    return next;
  }
  void fail(const std::string& what) {
    if (tally_.failure.empty()) tally_.failure = what;
  }

  simulated::Chance chance_;
  testing::TestApplication app_;
  const std::vector<std::byte> device_ = testing::bytes_of("tty0");
  std::vector<std::vector<TaskId>> sets_;
  std::vector<NamedSet> named_;
  std::vector<ScriptAct> acts_;
  Nanoseconds now_ = milliseconds(5);
  Tally tally_;
};

}  // namespace

Tally run_on_trial(std::uint64_t seed, std::uint32_t n_acts) {
  return std::make_unique<OnRun>(seed, n_acts)->go();
}

}  // namespace chimera::switching_trial
