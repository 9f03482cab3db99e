// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/subsystem.h"

#include <algorithm>

#include "chimera/subsystem/acts.h"
#include "chimera/subsystem/deaths.h"
#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/situation.h"
#include "chimera/subsystem/transaction.h"
#include "chimera/subsystem/wishes.h"

namespace chimera::subsystem {
namespace {

/// `init` and `kill` may take longer than an answer: while one is under way, it is waited for at most this long.
constexpr Nanoseconds kServiceLimit = seconds(60);

/// Did the signal lead where it should?
bool is_reached(const Reported& report) {
  switch (report.signal) {
    case Signal::kSpawn:
    case Signal::kOff:
    case Signal::kClear: return report.after == State::kOff;
    case Signal::kOn: return report.after == State::kOn;
    case Signal::kKill: return report.after == State::kNotCreated;
    default: return report.after == report.before;
  }
}

}  // namespace

struct Subsystem::Parts {
  explicit Parts(const ApplicationSpec& spec)
      : at(spec), goals(at), transaction(at, goals), acts(at, goals, transaction), wishes(at, goals, transaction),
        deaths(at, goals, transaction, acts) {}

  void take(const Begun& begun);
  void take(const InventoryComplete&) {
    at.is_complete = true;
    at.complete_since = at.now;
  }
  void take(const RtpuUp& up);
  void take(const RtpuDown& down);
  void take(const TaskSeen& seen);
  void take(const Reported& report);
  void take(const Requested& request) {
    if (request.signal == Signal::kOn) wishes.add(request);
  }
  void take(const Commanded& command) {
    if (command.signal == Signal::kOn) wishes.add(command);
    else acts.add(command);
  }
  void take(const Tick&) {}

  void give(const Reply& reply);
  void expire();
  void settle();

  Situation at;
  Goals goals;
  Transaction transaction;
  Acts acts;
  Wishes wishes;
  Deaths deaths;
};

void Subsystem::Parts::take(const Begun& begun) {
  at.mail.begin(at.now);
  goals.recall(begun.goals);
  deaths.recall(begun);
  for (std::size_t r = 0; r < at.spec.rtpus.size(); ++r) at.roster.starting(RtpuId(r), at.now);
  if (begun.started) return;
  at.roster.begin_empty();
  for (TaskId task : at.spec.init_order) {
    const bool starts = std::find(at.spec.start.begin(), at.spec.start.end(), task) != at.spec.start.end();
    goals.set(task, starts ? kGoalSpawn | kGoalOn : kGoalSpawn);
  }
  at.act(RememberStarted{});
}

void Subsystem::Parts::take(const RtpuUp& up) {
  at.roster.up(up.rtpu, up.incarnation);
  for (TaskId task : at.order) {
    if (at.roster.rtpu(task) != up.rtpu) continue;
    if (!goals.has(task, kGoalSpawn)) at.roster.forget(task);
    goals.clear(task, kGoalGone);
  }
}

void Subsystem::Parts::take(const RtpuDown& down) {
  if (!deaths.take(down)) return;
  for (TaskId task : at.order) {
    if (at.roster.rtpu(task) != down.rtpu) continue;
    const auto lost = at.mail.of(task);
    at.mail.drop(task);
    for (const Underway& entry : lost)
      if (entry.due != kNever)
        give({entry.command, task, entry.signal, false, true, false, State::kError, State::kError,
              at.name(down.rtpu) + " " + down.cause});
  }
}

void Subsystem::Parts::take(const TaskSeen& seen) {
  at.roster.see(seen.task, seen.status);
  transaction.look(seen.task);
}

void Subsystem::Parts::take(const Reported& report) {
  if (!at.mail.settle(report.task, report.command)) return;
  Reply reply{report.command, report.task, report.signal, report.accepted && is_reached(report), false, false,
              report.before, report.after, report.text};
  if (!reply.is_done && report.accepted) {
    reply.is_fault = true;
    if (reply.why.empty()) reply.why = std::string("ended in state ") + state_name(report.after);
  } else if (report.why == Refusal::kFault) {
    reply.is_fault = true;
    if (reply.why.empty()) reply.why = "a method failed";
  } else if (report.why == Refusal::kState) {
    reply.why = at.illegal(report.signal, report.task, report.before, {&report.task, 1});
  }
  give(reply);
}

void Subsystem::Parts::give(const Reply& reply) {
  transaction.take(reply);
  goals.take(reply);
  acts.take(reply);
}

void Subsystem::Parts::expire() {
  for (TaskId task : at.order) {
    std::vector<Reply> expired;
    for (Underway& entry : at.mail.of(task)) {
      if (entry.due > at.now) continue;
      const bool serves = at.roster.status(task).in_service && at.now < entry.sent + kServiceLimit;
      entry.due = serves ? at.now + kAnswerLimit : kNever;
      const State state = at.roster.state(task);
      if (!serves)
        expired.push_back({entry.command, task, entry.signal, false, false, false, state, state, at.no_answer(task)});
    }
    for (const Reply& reply : expired) give(reply);
  }
}

// Each part may open the way for another; whatever happens shows as an action.
void Subsystem::Parts::settle() {
  for (std::size_t before = SIZE_MAX; before != at.actions->size();) {
    before = at.actions->size();
    goals.pursue();
    acts.advance();
    transaction.advance();
    wishes.advance();
  }
}

Subsystem::Subsystem(const ApplicationSpec& spec) : parts_(std::make_unique<Parts>(spec)) {}
Subsystem::~Subsystem() = default;

void Subsystem::step(const Event& event, Nanoseconds now, std::vector<Action>& actions) {
  parts_->at.now = now;
  parts_->at.actions = &actions;
  std::visit([this](const auto& it) { parts_->take(it); }, event);
  parts_->expire();
  if (parts_->at.is_complete) parts_->settle();
}

Nanoseconds Subsystem::next_due() const noexcept {
  const auto& parts = *parts_;
  return std::min({parts.at.mail.next_due(), parts.goals.next_due(), parts.acts.next_due(), parts.wishes.next_due()});
}

State Subsystem::state(TaskId task) const noexcept { return parts_->at.roster.state(task); }

bool Subsystem::is_settled() const noexcept {
  return !parts_->goals.any(kGoalSpawn | kGoalOn) && !parts_->transaction.is_under_way();
}

bool Subsystem::is_given_up(RtpuId rtpu) const noexcept { return parts_->at.roster.life(rtpu) == Life::kDown; }

std::string Subsystem::way_back(RtpuId rtpu) const { return parts_->deaths.way_back(rtpu); }

std::string Subsystem::missing() const { return parts_->at.missing(); }

std::string Subsystem::judge_on(std::span<const TaskId> tasks) const { return parts_->at.judge_on(tasks); }

}  // namespace chimera::subsystem
