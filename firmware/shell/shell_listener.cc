// SPDX-License-Identifier: Apache-2.0
// Carries out the acts of an operator at a cycle boundary.
#include "firmware/shell/shell_listener.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/runtime/cycle/boundary_signals.h"
#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/life/refusal_words.h"

namespace chimera::firmware {
namespace {

constexpr std::size_t kLookedAtOnce = 4;

/// The switch of the receipt is not under way any more.
bool is_over(const SwitchReceipt& receipt) noexcept {
  return receipt.end != SwitchEnd::kRefused || receipt.why != NoSwitch::kNone;
}

}  // namespace

ShellListener::ShellListener(TaskSet& set, SetupMemory& memory)
    : BoundaryListener(rings_), set_(set), seen_(memory.take<Seen>(set.tasks().size())) {}

void ShellListener::ask(const ShellAct& act) noexcept {
  CHIMERA_ASSERT(is_done());
  act_ = &act;
  // No other thread writes it, and a Cortex-M0+ has no atomic addition.
  rings_.store(rings_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

void ShellListener::take(BoundarySignals& signals, Nanoseconds now) noexcept {
  listen();
  now_ = now;
  if (act_ == nullptr) return;
  refusal_.clear();
  switch (act_->kind) {
    case ShellAct::Kind::kSignal: carry_out_signal(signals, now); break;
    case ShellAct::Kind::kSwitch: order_switch(signals, now); break;
    case ShellAct::Kind::kSet: {
      ScriptAct act;
      act.kind = ScriptAct::Kind::kSet;
      act.operator_index = act_->index;
      act.value = act_->value;
      signals.act(act, now);
      break;
    }
  }
  act_ = nullptr;
}

void ShellListener::carry_out_signal(BoundarySignals& signals, Nanoseconds now) noexcept {
  const std::span<const TaskId> tasks(act_->tasks.begin(), act_->tasks.size());
  for (const TaskId id : tasks) {
    if (signals.may_touch(id)) continue;
    refusal_.put("%s has a job under way: try again", set_.spec().tasks[id.index].name);
    return;
  }
  SignalReport report = signals.operate(tasks, act_->signal, now);
  if (report.is_accepted && !has_arrived(report.signal, report.before, report.after)) {
    report.is_accepted = false;
    if (report.why == Refusal::kNone) report.why = Refusal::kFault;
  }
  put_refusal(set_, report, [this](std::string_view part) { refusal_ << part; });
  for (const TaskId id : tasks) note_news(set_.tasks()[id.index], now);
}

void ShellListener::order_switch(BoundarySignals& signals, Nanoseconds now) noexcept {
  if (receipts_ == nullptr || !may_request(set_.spec())) {
    refusal_.put("this application has no switches");
    return;
  }
  ScriptAct act;
  act.kind = ScriptAct::Kind::kSwitch;
  act.set = act_->index;
  signals.act(act, now);
  const std::span<const SwitchReceipt> all = receipts_->all();
  const bool is_kept = !all.empty() && all.back().asked == now && all.back().cause == SwitchCause::kScript;
  if (!is_kept) {
    refusal_.put("another switch is under way");
    return;
  }
  ordered_ = &all.back();
  ordered_number_ = ordered_->number;
}

bool ShellListener::is_switch_over() const noexcept {
  const SwitchReceipt* const receipt = ordered();
  return receipt == nullptr || is_over(*receipt);
}

void ShellListener::told(const SignalReport& report, Nanoseconds now) noexcept {
  note_news(set_.tasks()[report.task.index], now);
}

void ShellListener::show(const Task& task) noexcept { note_news(task, std::max(now_, task.faults.at)); }

void ShellListener::missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept {
  note_news(set_.tasks()[task.index], now);
  ShellEvent& event = events_.note(now, ShellEventKind::kMissed, task, 0);
  if (verdict.culprit.is_valid()) event.other = verdict.culprit;
}

void ShellListener::look(Nanoseconds now) noexcept {
  now_ = now;
  const std::size_t n = seen_.size();
  for (std::size_t looked = 0; looked < std::min(kLookedAtOnce, n); ++looked) {
    note_news(set_.tasks()[next_], now);
    next_ = next_ + 1 == n ? 0 : next_ + 1;
  }
  note_switch(now);
}

void ShellListener::note_news(const Task& task, Nanoseconds now) noexcept {
  Seen& seen = seen_[task.id.index];
  const auto faults = static_cast<std::uint32_t>(task.faults.count);
  if (faults != seen.faults) {
    const TaskFaults& log = task.faults;
    events_.note(log.at, ShellEventKind::kFault, task.id, faults - seen.faults, log.method, log.last.code)
        .text.assign(log.last.text);
    seen.faults = faults;
  }
  const auto missed = static_cast<std::uint32_t>(task.profile.missed);
  if (missed != seen.missed) {
    const std::uint32_t news = missed < seen.missed ? missed : missed - seen.missed;  // a new incarnation counts from 0
    if (news != 0) events_.note(now, ShellEventKind::kMissed, task.id, news);
    seen.missed = missed;
  }
  const State state = task.shown_state();
  if (state == seen.state) return;
  ShellEvent& event = events_.note(now, ShellEventKind::kState, task.id);
  event.before = seen.state;
  event.after = state;
  seen.state = state;
}

void ShellListener::note_switch(Nanoseconds now) noexcept {
  if (receipts_ == nullptr || receipts_->all().empty()) return;
  const SwitchReceipt& last = receipts_->all().back();
  if (last.number == noted_switch_ || !is_over(last)) return;
  noted_switch_ = last.number;
  if (last.end == SwitchEnd::kNothingToDo) return;
  ShellEvent& event =
      events_.note(last.ended == kNever ? now : last.ended, ShellEventKind::kSwitch, last.task);
  event.end = last.end;
  event.why = last.why;
  event.from = last.before;
  event.to = last.after;
  for (const TaskPart& part : last.tasks) event.lost += static_cast<std::uint32_t>(part.lost);
}

}  // namespace chimera::firmware
