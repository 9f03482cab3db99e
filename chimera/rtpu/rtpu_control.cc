// SPDX-License-Identifier: Apache-2.0
// Takes messages of other processes between two cycles, and carries out the signals in them step by step.
#include "chimera/rtpu/rtpu_control.h"

#include <algorithm>

#include "chimera/platform/wake_event.h"
#include "chimera/runtime/boundary_signals.h"
#include "chimera/runtime/task_word.h"

namespace chimera {
namespace {

constexpr std::size_t kShownAtOnce = 4;
constexpr Nanoseconds kLookWhileEnding = milliseconds(1);

// The first that a signal calls.
Method method_of(Signal signal) noexcept {
  switch (signal) {
    case Signal::kSpawn:
      return Method::kInit;
    case Signal::kOn:
      return Method::kOn;
    case Signal::kOff:
      return Method::kOff;
    case Signal::kKill:
      return Method::kKill;
    case Signal::kClear:
      return Method::kClear;
    case Signal::kReinit:
      return Method::kReinit;
    default:
      return Method::kCycle;
  }
}

}  // namespace

RtpuControl::RtpuControl(const ApplicationSpec& spec, TaskSet& tasks, PeerLinks& others, Service& service,
                  DecisionPage& decision, std::uint32_t me, Nanoseconds method_limit)
    : BoundaryListener(decision.bells[me].word),
      spec_(spec),
      tasks_(tasks),
      others_(others),
      service_(service),
      method_limit_(method_limit),
      seen_changes_(others.changes() - 1),
      blocked_(spec.tasks.size()),
      commands_(spec.tasks.size()),
      hangs_(spec.tasks.size()) {
  set_due({});  // the first edge looks around
}

void RtpuControl::begin() noexcept {
  others_.watch_flags(tasks_.flag());
  others_.publish_all(tasks_);
}

void RtpuControl::take(BoundarySignals& signals, Nanoseconds now) noexcept {
  listen();
  set_due(kNever);
  others_.block().head().beats.fetch_add(1, std::memory_order_relaxed);
  check_peers();
  take_slow(signals, now);
  if (ending_) return go_on_ending(signals, now);  // nothing is begun any more
  read_posts();
  act_on_waiting(signals, now);
}

void RtpuControl::check_peers() noexcept {
  const bool is_new = others_.adopt(tasks_);
  const std::uint32_t changes = others_.changes();
  if (!is_new && changes == seen_changes_) return;
  seen_changes_ = changes;
  others_.watch_flags(tasks_.flag());  // others may live now, or be dead
  tasks_.sources().follow_others();
  tasks_.on_set_changed();
  for (Task& task : tasks_.tasks()) task.is_tapped = tasks_.is_mine(task.id) && others_.is_wanted_on_tap(task.id);
  publish();
  others_.block().head().seen_changes.store(changes, std::memory_order_release);
}

void RtpuControl::read_posts() noexcept {
  for (Post post; !waiting_.is_full() && others_.pop(post);) {
    const bool is_for_us =
        post.kind == PostKind::kSignal && post.task.index < spec_.tasks.size() && tasks_.is_mine(post.task);
    if (!is_for_us) continue;
    if (post.signal == Signal::kWakeup)
      (void)tasks_.sent().ring(post.task);
    else
      (void)waiting_.try_push(post);
  }
}

void RtpuControl::take_slow(BoundarySignals& signals, Nanoseconds now) noexcept {
  for (TaskId task; service_.take_served(task);) {
    const SignalReport done = signals.finish_slow(task, now);
    publish();
    if (done.is_deferred) continue;
    report(commands_[task.index], done, now);
    commands_[task.index] = {};
  }
}

// A step is a signal with those that belong to one transaction with it; 0: the rest of it is still to come.
std::size_t RtpuControl::step_length(std::size_t first) const noexcept {
  for (std::size_t i = first; i < waiting_.size(); ++i)
    if (!waiting_[i].more) return i - first + 1;
  return waiting_.is_full() ? waiting_.size() - first : 0;
}

// A task keeps the order of its signals: one that is being served, or that has an earlier signal waiting, waits.
bool RtpuControl::may_act(std::span<const Post> step, BoundarySignals& signals) noexcept {
  bool may = true;
  for (const Post& post : step) {
    const Task& task = tasks_.tasks()[post.task.index];
    may = may && !task.in_service && !blocked_[post.task.index] && signals.may_touch(post.task);
  }
  if (!may)
    for (const Post& post : step) blocked_[post.task.index] = true;
  return may;
}

void RtpuControl::act_on_waiting(BoundarySignals& signals, Nanoseconds now) noexcept {
  std::fill(blocked_.begin(), blocked_.end(), false);
  std::size_t kept = 0, at = 0;
  while (at < waiting_.size()) {
    const std::size_t n = step_length(at);
    const std::span<const Post> step(waiting_.begin() + at, n == 0 ? waiting_.size() - at : n);
    at += step.size();
    if (n != 0 && may_act(step, signals)) {
      act(step, signals, now);
      continue;
    }
    for (const Post& post : step) waiting_[kept++] = post;
  }
  while (waiting_.size() > kept) waiting_.pop_back();
}

bool RtpuControl::refuse_illegal(std::span<const Post> step, Nanoseconds now) noexcept {
  const auto is_illegal = [this](const Post& post) {
    const Task& task = tasks_.tasks()[post.task.index];
    return next(task.state, post.signal, task.spec->aperiodic).kind == Next::Kind::kImpossible;
  };
  const auto culprit = std::find_if(step.begin(), step.end(), is_illegal);
  if (culprit == step.end()) return false;
  for (const Post& post : step) {
    const State state = tasks_.tasks()[post.task.index].state;
    report(post, state, state, &post == &*culprit ? Refusal::kState : Refusal::kNone, false, now);
  }
  return true;
}

void RtpuControl::act(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept {
  if (refuse_illegal(step, now)) return;
  if (step[0].signal == Signal::kOn) return turn_on(step, signals, now);
  for (const Post& post : step) {
    const bool is_echo = post.signal == Signal::kReinit && post.detail != 0;
    if (is_echo) tasks_.constants().read_foreign();
    if (is_echo && !tasks_.constants().uses_changed(post.task)) continue;
    const SignalReport done = carry_out(signals, {&post.task, 1}, post.signal, now);
    if (done.is_deferred)
      commands_[post.task.index] = post;
    else
      report(post, done, now);
  }
}

void RtpuControl::turn_on(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept {
  FixedVector<TaskId, kWaiting> tasks;
  for (const Post& post : step) (void)tasks.try_push(post.task);
  const SignalReport done = carry_out(signals, {tasks.begin(), tasks.size()}, Signal::kOn, now);
  for (const Post& post : step) {
    const State after = tasks_.tasks()[post.task.index].state;
    const Refusal why = post.task == done.task ? done.why : Refusal::kNone;
    report(post, State::kOff, after, why, done.is_accepted && after == State::kOn, now);
  }
}

void RtpuControl::report(const Post& signal, const SignalReport& done, Nanoseconds now) noexcept {
  const bool arrived = done.is_accepted && has_arrived(done.signal, done.before, done.after);
  const Refusal why = arrived || done.why != Refusal::kNone ? done.why : Refusal::kFault;
  report(signal, done.before, done.after, why, arrived, now);
}

// What is carried out behind the last words is undone by the end of the process: its death is the answer, so that the
// successor is asked again.
void RtpuControl::report(const Post& signal, State before, State after, Refusal why, bool accepted,
                         Nanoseconds now) noexcept {
  if (others_.keeps_last_words()) return;
  Post post = signal;
  post.at = now;
  post.kind = PostKind::kReport;
  post.more = false;
  post.why = static_cast<std::uint8_t>(why);
  post.before = before;
  post.after = after;
  post.detail = accepted ? 1 : 0;
  if (signal.command == 0) {
    if (!signal.task.is_valid() || !signal.from.is_valid()) return;  // nobody asked
    post.kind = PostKind::kEvent;
    post.happening = accepted ? EventKind::kSignalled : EventKind::kRefused;
  }
  this->post(post);
}

// What the manager's log says comes after what it is about.
void RtpuControl::post(const Post& post) noexcept {
  publish();
  others_.send(post);
}

void RtpuControl::post_event(EventKind happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept {
  publish();
  others_.send_event(happening, task, detail, at);
}

void RtpuControl::told(const SignalReport& done, Nanoseconds now) noexcept {
  Post post;
  post.at = now;
  post.task = done.task;
  post.signal = done.signal;
  post.kind = PostKind::kEvent;
  post.happening = done.is_accepted ? EventKind::kSignalled : EventKind::kRefused;
  post.why = static_cast<std::uint8_t>(done.why);
  post.before = done.before;
  post.after = done.after;
  this->post(post);
}

void RtpuControl::missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept {
  Post post;
  post.at = now;
  post.task = task;
  post.from = verdict.culprit;
  post.kind = PostKind::kEvent;
  post.happening = verdict.is_blocked ? EventKind::kBlocked : EventKind::kMissed;
  post.detail = static_cast<std::uint64_t>(verdict.used.count);
  this->post(post);
}

void RtpuControl::gave_way(TaskId task, Nanoseconds used, Nanoseconds now) noexcept {
  post_event(EventKind::kGaveWay, task, static_cast<std::uint64_t>(used.count), now);
}

void RtpuControl::hangs(TaskWord job, Nanoseconds age, Nanoseconds now) noexcept {
  post_event(EventKind::kHang, job.task(), static_cast<std::uint64_t>(age.count), now);
  hangs_[job.task().index] = true;
  others_.keep_last_words(true, tasks_);
  hanging_age_ = age.count;
  hanging_job_ = job.word();
  hanging_ = true;
  wake_supervisor();
}

// Carries out a signal and publishes its method for the supervisor, because the method may not return.
SignalReport RtpuControl::carry_out(BoundarySignals& signals, std::span<const TaskId> tasks, Signal signal,
                                    Nanoseconds now) noexcept {
  acting_ = TaskWord(tasks[0], method_of(signal)).word();
  ++progress_;
  const SignalReport done = signals.signal(tasks, signal, now);
  publish();
  acting_ = 0;
  ++progress_;
  return done;
}

void RtpuControl::wake_supervisor() noexcept {
  if (supervisor_ >= 0) ring_event(supervisor_);
}

void RtpuControl::stop_all(BoundarySignals& signals, TaskId stopped_by, Nanoseconds now) noexcept {
  post_event(EventKind::kStop, stopped_by, 0, now);
  for (const TaskId id : spec_.end_order) {
    Task& task = tasks_.tasks()[id.index];
    if (!tasks_.is_mine(id) || task.state != State::kOn) continue;
    if (signals.may_touch(id))
      (void)carry_out(signals, {&id, 1}, Signal::kOff, now);
    else
      tasks_.sent().defer(task, Signal::kOff);  // its job is late, and is not waited for
  }
}

void RtpuControl::show_profiles() noexcept {
  const std::size_t n = spec_.tasks.size();
  for (std::size_t looked = 0, shown = 0; looked < n && shown < kShownAtOnce; ++looked) {
    const TaskId id(shown_);
    shown_ = (shown_ + 1) % n;
    if (!tasks_.is_mine(id)) continue;
    others_.block().profile(id) = tasks_.tasks()[id.index].profile;
    ++shown;
  }
}

void RtpuControl::go_on_ending(BoundarySignals& signals, Nanoseconds now) noexcept {
  others_.keep_last_words(ends_alone_, tasks_);
  if (!has_begun_ending_) {
    has_begun_ending_ = true;
    patience_ = now + method_limit_;
    others_.block().head().phase.store(PeerPhase::kEnding, std::memory_order_release);
  }
  if (!turn_off_next(signals, now) || !kill_next(signals, now)) return set_due(now + kLookWhileEnding);
  others_.block().head().phase.store(PeerPhase::kEnded, std::memory_order_release);
  over_ = true;
  wake_supervisor();
  set_due(now);  // no wait comes between this and the look at it
}

// True when none of ours is ON any more. Tasks of others that come first are waited for, not for ever.
bool RtpuControl::turn_off_next(BoundarySignals& signals, Nanoseconds now) noexcept {
  for (; next_off_ < spec_.end_order.size(); ++next_off_) {
    const TaskId id = spec_.end_order[next_off_];
    if (!tasks_.is_mine(id)) {
      if (others_.state(id) == State::kOn && now < patience_ && !hanging_) return false;
      continue;
    }
    if (tasks_.tasks()[id.index].state != State::kOn) continue;
    if (!signals.may_touch(id)) {  // its job ends, or hangs
      if (now < patience_ && !hangs_[id.index]) return false;
      continue;
    }
    (void)carry_out(signals, {&id, 1}, Signal::kOff, now);
    patience_ = now + method_limit_;
  }
  return true;
}

// True when all of ours are killed.
bool RtpuControl::kill_next(BoundarySignals& signals, Nanoseconds now) noexcept {
  bool is_done = true;
  for (const TaskId id : spec_.end_order) {
    if (!tasks_.is_mine(id)) continue;
    const Task& task = tasks_.tasks()[id.index];
    if (task.in_service) return false;
    if (task.state == State::kNotCreated) continue;
    if (!signals.may_touch(id)) {
      is_done = is_done && hangs_[id.index];
      continue;
    }
    if (carry_out(signals, {&id, 1}, Signal::kKill, now).is_deferred) return false;
  }
  return is_done;
}

}  // namespace chimera
