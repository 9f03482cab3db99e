// SPDX-License-Identifier: Apache-2.0
// Advances the processors of several rtpus on one clock, instant by instant.
#include "chimera/runtime/virtual/virtual_rtpus.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/runtime/hosted/refusal_text.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/set_equations.h"
#include "chimera/runtime/virtual/stepped_executive.h"
#include "chimera/runtime/virtual/stepped_preemptive.h"

namespace chimera {
namespace {

constexpr std::atomic<bool> kNoStop{false};
constexpr std::size_t kMostRefused = 1024;
// Tasks of several rtpus may send each other signals for ever: releases have their turn after kMostEdges passes.
constexpr int kMostEdges = 16;

std::vector<Silence> silences_of(const ApplicationSpec& spec) {
  std::vector<Silence> silences;
  for (const StandbySpec& each : spec.standbys)
    if (each.stale_after.count > 0) silences.push_back(Silence::of(each, spec.tasks[each.primary.index].period));
  return silences;
}

}  // namespace

/// One rtpu.
struct VirtualRtpus::Rtpu {
  Rtpu(VirtualPeers& peers, RtpuId rtpu, SwitchPeers* switches, const RunOptions& run, const VirtualOptions& how)
      : id(rtpu),
        tasks(*peers.tasks(rtpu)),
        control(peers, rtpu, run.script.size()),
        releases(tasks, clock, options(run, switches, how)) {
    const std::span<const TaskSpec> specs = tasks.spec().tasks;
    if (is_preemptive(how))
      processor =
          std::make_unique<SteppedPreemptive>(releases, specs, clock, PreemptiveOptions{how.times, how.quantum});
    else
      processor = std::make_unique<SteppedExecutive>(releases, clock, how.times);
    if (how.times && how.times->are_zero) clock.stand_still();
    for (const Task& task : tasks.tasks())
      CHIMERA_ASSERT(!tasks.is_mine(task.id) || is_preemptive(how) || !task.spec->server);
  }
  bool is_preemptive(const VirtualOptions& how) const noexcept {
    return how.preemptive || tasks.spec().rtpus[id.index].preemptive;
  }
  RunOptions options(RunOptions run, SwitchPeers* switches, const VirtualOptions& how) noexcept {
    run.policy = tasks.spec().rtpus[id.index].policy;
    run.rtpu = static_cast<std::uint8_t>(id.index);
    run.script = Script();
    run.guest = &control;
    run.switch_peers = switches;
    run.preemptive = is_preemptive(how);
    return run;
  }

  RtpuId id;
  TaskSet& tasks;
  ModelledClock clock;
  VirtualControl control;
  Releases releases;
  std::unique_ptr<SteppedProcessor> processor;
  Nanoseconds next = Nanoseconds{};  // when it has something to do, if nothing comes from elsewhere
  bool acts_now = false;             // it takes part in the present instant
  bool is_dead = false;
};

VirtualRtpus::VirtualRtpus(VirtualPeers& peers, const RunOptions& options, const VirtualOptions& how)
    : peers_(peers),
      stop_(options.stop != nullptr ? options.stop : &kNoStop),
      script_(options.script),
      switches_(peers) {
  CHIMERA_ASSERT(how.quantum > Nanoseconds{} && options.guest == nullptr);
  const auto n_rtpus = static_cast<std::uint32_t>(peers.spec().rtpus.size());
  const std::size_t n_receipts = script_.count(ScriptAct::Kind::kSwitch) + kept_of_unscripted(peers.spec());
  if (n_receipts > 0) switches_.prepare(peers.spec(), n_rtpus, n_receipts, options.asked, memory_);
  for (std::uint32_t r = 0; r < n_rtpus; ++r) {
    if (peers.tasks(RtpuId(r)) == nullptr) continue;
    SwitchPeers* const switches = n_receipts > 0 ? &switches_.of(r) : nullptr;
    rtpus_.push_back(std::make_unique<Rtpu>(peers, RtpuId(r), switches, options, how));
    if (n_receipts > 0) switches_.join(r, *peers.tasks(RtpuId(r)), !rtpus_.back()->is_preemptive(how));
  }
  silences_ = silences_of(peers.spec());
  of_dead_.reserve(kMostRefused);
}

VirtualRtpus::~VirtualRtpus() = default;

VirtualRtpus::Rtpu& VirtualRtpus::rtpu_of(TaskId task) noexcept {
  const RtpuId rtpu = peers_.spec().tasks[task.index].rtpu;
  return **std::find_if(rtpus_.begin(), rtpus_.end(), [rtpu](const auto& one) { return one->id == rtpu; });
}

Result<void> VirtualRtpus::start() {
  peers_.show_start(true);
  Result<void> started = spawn_all();
  if (started) started = turn_on_all();
  peers_.show_start(false);
  if (!started) return started;
  origin_ = now_;
  switches_.begin(origin_);
  for (const auto& rtpu : rtpus_) {
    rtpu->control.follow(now_);
    rtpu->control.publish();
    rtpu->control.record_on(rtpu->releases.tap());
    rtpu->clock.set(now_);
    rtpu->releases.begin(origin_);
  }
  return {};
}

// The times of methods add up, one after the other, even if they run on different rtpus.
SignalReport VirtualRtpus::signal(TaskId task, Signal signal) {
  Rtpu& rtpu = rtpu_of(task);
  rtpu.clock.set(now_);
  rtpu.control.follow({});
  const SignalReport report = rtpu.tasks.life().signal(task, signal, {});
  rtpu.control.publish();
  now_ = rtpu.clock.now();
  return report;
}

Result<void> VirtualRtpus::spawn_all() {
  for (const TaskId id : peers_.spec().init_order) {
    if (!rtpu_of(id).tasks.life().judge().rivals().is_created_at_start(id)) continue;
    const SignalReport report = signal(id, Signal::kSpawn);
    if (rtpu_of(id).tasks.tasks()[id.index].state == State::kOff) continue;
    SignalReport refused = report;
    refused.is_accepted = false;
    refused.why = Refusal::kFault;
    return start_result(rtpu_of(id).tasks, refused);
  }
  return {};
}

Result<void> VirtualRtpus::turn_on_all() {
  const ApplicationSpec& spec = peers_.spec();
  std::vector<bool> wanted(spec.tasks.size());
  for (const TaskId id : spec.start) wanted[id.index] = true;
  if (!is_legal_set(spec.variables, wanted))
    return Error{ErrorCode::kRefused, {Variables(spec).explain(wanted, spec.tasks)}, {spec.name}};
  for (const TaskId id : spec.start) {
    SignalReport report = signal(id, Signal::kOn);
    for (const Nanoseconds until = now_ + kReadyLimit; report.why == Refusal::kNotYet && now_ < until;) {
      now_ = now_ + TaskLife::kAskAgain;
      report = signal(id, Signal::kOn);
    }
    if (report.is_accepted && report.after == State::kOn) continue;
    for (const TaskId done : spec.start) {  // one transaction: tasks that are ON already go OFF again
      if (done == id) break;
      (void)signal(done, Signal::kOff);
    }
    report.is_accepted = false;
    if (report.why != Refusal::kNotYet) report.why = Refusal::kFault;
    return start_result(rtpu_of(id).tasks, report);
  }
  return {};
}

RunEnd VirtualRtpus::run_to(Nanoseconds duration) noexcept {
  const Nanoseconds until = duration == kNever ? kNever : origin_ + duration;
  for (;;) {
    for (const auto& rtpu : rtpus_) rtpu->acts_now = !rtpu->is_dead && (rtpu->next <= now_ || is_due(*rtpu));
    for (const auto& rtpu : rtpus_)
      if (rtpu->acts_now) rtpu->processor->end_jobs(now_);
    if (stop_->load(std::memory_order_relaxed)) return RunEnd::kStopped;
    if (now_ >= until) return RunEnd::kTime;
    stop_rtpus();
    take_acts();
    if (!silences_.empty()) look_for_silence();
    take_edges();
    (void)switches_.look(now_);
    if (begin_jobs()) continue;
    if (!is_anything_left()) return RunEnd::kNothingLeft;
    const Nanoseconds next = std::min(next_event(), until);
    if (next == kNever) return RunEnd::kNothingLeft;
    now_ = std::max(next, now_);
  }
}

RunEnd VirtualRtpus::run(Nanoseconds duration) noexcept {
  const RunEnd end = run_to(duration);
  if (end != RunEnd::kTime) return end;
  Nanoseconds last = now_;
  for (const auto& rtpu : rtpus_)
    if (!rtpu->is_dead) last = std::max(last, rtpu->processor->finish(now_));
  now_ = last;
  return end;
}

// True if the rtpu has new input and is free to handle it.
bool VirtualRtpus::is_due(const Rtpu& rtpu) const noexcept {
  return !rtpu.is_dead && rtpu.control.is_due(now_) && !rtpu.processor->is_occupied(now_);
}

// The reaction `stop` of a task: all tasks of the rtpu go OFF, and the others go on.
void VirtualRtpus::stop_rtpus() noexcept {
  for (const auto& rtpu : rtpus_) {
    if (rtpu->is_dead || !rtpu->releases.settlement().task_stopped()) continue;
    rtpu->releases.settlement().forget_stop();
    rtpu->control.stop_all();
  }
}

// In the order of the script: before an act for another rtpu, the cycle boundary of the last rtpu carries out its acts.
void VirtualRtpus::take_acts() noexcept {
  Rtpu* last = nullptr;
  while (const ScriptAct* next = script_.take(now_ - origin_)) act(*next, last);
}

void VirtualRtpus::act(const ScriptAct& act, Rtpu*& last) noexcept {
  Rtpu* const rtpu = act.kind == ScriptAct::Kind::kSignal ? &rtpu_of(act.task) : nullptr;
  if (last != nullptr && last != rtpu) take_edge(*last);
  last = rtpu;
  switch (act.kind) {
    case ScriptAct::Kind::kSignal:
      if (!rtpu->is_dead) return rtpu->control.hand_over(act);
      if (of_dead_.size() < kMostRefused)
        of_dead_.push_back({now_, act.task, act.signal, Refusal::kState, peers_.state(act.task)});
      return;
    case ScriptAct::Kind::kSet:
      return peers_.set_operator(act.operator_index, act.value, now_);
    case ScriptAct::Kind::kRaiseFlag:
      return peers_.raise(true);
    case ScriptAct::Kind::kLowerFlag:
      return lower_flag(act);
    case ScriptAct::Kind::kDie:
      return die(act.rtpu);
    case ScriptAct::Kind::kSwitch:
      return switches_.ask(act.request(), now_);
  }
}

// Lowered, it is also for the tasks that hold it up.
void VirtualRtpus::lower_flag(const ScriptAct& act) noexcept {
  peers_.raise(false);
  for (const auto& rtpu : rtpus_)
    if (!rtpu->is_dead && rtpu->tasks.flag().is_raised()) rtpu->control.hand_over(act);
}

void VirtualRtpus::die(RtpuId rtpu) noexcept {
  const auto found = std::find_if(rtpus_.begin(), rtpus_.end(), [rtpu](const auto& one) { return one->id == rtpu; });
  if (found == rtpus_.end() || (*found)->is_dead) return;
  Rtpu& dead = **found;
  dead.processor->cut(now_);
  dead.is_dead = true;
  dead.acts_now = false;
  peers_.die(rtpu, now_);
  switches_.die(rtpu.index);
  for (Task& task : dead.tasks.tasks()) {
    if (!dead.tasks.is_mine(task.id) || task.state == State::kNotCreated) continue;
    dead.releases.tap().record(TapKind::kState, now_, task.id, static_cast<std::uint64_t>(State::kError));
    task.profile.on_before = task.profile.on_by(now_);
    task.profile.on_since = kNever;
  }
}

void VirtualRtpus::look_for_silence() noexcept {
  for (Silence& silence : silences_) {
    if (silence.due() > now_) continue;
    const TaskId primary = silence.task();
    const bool is_on = peers_.state(primary) == State::kOn && peers_.state(silence.standby()) == State::kOff;
    const GroupReader group = peers_.outputs(primary);
    const std::uint64_t published = group.is_bound() ? group.published()->sequence : 0;
    if (silence.look(is_on, published, now_)) die(peers_.spec().tasks[primary.index].rtpu);
  }
}

void VirtualRtpus::take_edges() noexcept {
  for (int pass = 0; pass < kMostEdges; ++pass) {
    bool any = false;
    for (const auto& rtpu : rtpus_) any |= (is_due(*rtpu) || (pass == 0 && rtpu->acts_now)) && take_edge(*rtpu);
    if (!any) return;
  }
}

// True when one was due.
bool VirtualRtpus::take_edge(Rtpu& rtpu) noexcept {
  if (rtpu.is_dead || !rtpu.processor->edge_is_due(now_)) return false;
  if (!rtpu.acts_now) rtpu.processor->end_jobs(now_);
  rtpu.acts_now = true;
  rtpu.processor->take_edge(now_);
  return true;
}

// Releases, then starts. True when the instant is not over.
bool VirtualRtpus::begin_jobs() noexcept {
  for (const auto& rtpu : rtpus_)
    if (rtpu->acts_now) rtpu->processor->release_jobs(now_);
  bool goes_on = false;
  for (const auto& rtpu : rtpus_) {
    if (!rtpu->acts_now) continue;
    const bool again = rtpu->processor->dispatch(now_);
    rtpu->next = again ? now_ : rtpu->processor->next_event(now_);
    goes_on |= again;
  }
  return goes_on || std::any_of(rtpus_.begin(), rtpus_.end(), [this](const auto& rtpu) { return is_due(*rtpu); });
}

Nanoseconds VirtualRtpus::next_event() noexcept {
  const Nanoseconds at = script_.next_at();
  Nanoseconds next = at == kNever ? kNever : origin_ + at;
  for (const auto& rtpu : rtpus_)
    if (!rtpu->is_dead) next = std::min(next, rtpu->next);
  for (const Silence& silence : silences_)
    if (peers_.presence(silence.task()).lives) next = std::min(next, silence.due());
  return next;
}

bool VirtualRtpus::is_anything_left() noexcept {
  const auto is_left = [this](const auto& rtpu) {
    if (rtpu->is_dead) return false;
    const bool is_quiet = rtpu->processor->is_idle() && !rtpu->processor->is_occupied(now_);
    return !is_quiet || rtpu->releases.members().is_any_on() || rtpu->tasks.sent().has_pending();
  };
  return script_.next_at() != kNever || switches_.is_under_way() || std::any_of(rtpus_.begin(), rtpus_.end(), is_left);
}

void VirtualRtpus::shut_down() {
  for (const auto& rtpu : rtpus_) {
    if (rtpu->is_dead) continue;
    rtpu->clock.set(now_);
    rtpu->releases.end(now_);
  }
  switches_.end(now_);
  for (const auto& rtpu : rtpus_)
    if (!rtpu->is_dead) rtpu->tasks.life().shut_down(now_);
}

std::vector<RefusedSignal> VirtualRtpus::refused() {
  std::vector<RefusedSignal> all = of_dead_;
  const auto is_before = [](const RefusedSignal& a, const RefusedSignal& b) { return a.at < b.at; };
  for (const auto& rtpu : rtpus_)
    for (const RefusedSignal& one : rtpu->releases.signals().refused())
      all.insert(std::upper_bound(all.begin(), all.end(), one, is_before), one);
  return all;
}

}  // namespace chimera
