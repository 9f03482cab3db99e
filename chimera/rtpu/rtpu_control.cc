// SPDX-License-Identifier: Apache-2.0
// Reads messages of other processes between two cycles, and carries out the signals in them step by step.
#include "chimera/rtpu/rtpu_control.h"

#include <algorithm>

#include "chimera/runtime/cycle/boundary_signals.h"

namespace chimera {
namespace {

constexpr std::size_t kShownAtOnce = 4;
constexpr Nanoseconds kLookWhileEnding = milliseconds(1);

}  // namespace

RtpuControl::RtpuControl(const ApplicationSpec& spec, TaskSet& tasks, PeerLinks& others, Service& service,
                  DecisionPage& decision, std::uint32_t me, Nanoseconds method_limit)
    : BoundaryListener(decision.bells[me].word),
      spec_(spec),
      tasks_(tasks),
      others_(others),
      service_(service),
      supervised_(tasks, others),
      hanging_(spec.tasks.size()),
      end_(tasks, others, supervised_, hanging_, method_limit),
      seen_changes_(others.changes() - 1),
      waiting_(spec.tasks.size()),
      commands_(spec.tasks.size()) {
  set_due({});  // due at the first cycle boundary
}

void RtpuControl::begin() noexcept {
  others_.watch_flags(tasks_.flag());
  others_.publish_all(tasks_);
}

void RtpuControl::take(BoundarySignals& signals, Nanoseconds now) noexcept {
  listen();
  set_due(kNever);
  others_.block().head().beats.fetch_add(1, std::memory_order_relaxed);
  check_peers(now);
  take_slow(signals, now);
  if (end_.is_told()) return go_on_ending(signals, now);  // no new signal begins any more
  read_posts();
  const auto may_touch = [&](TaskId id) { return !tasks_.tasks()[id.index].in_service() && signals.may_touch(id); };
  waiting_.act(may_touch, [&](std::span<const Post> step) { act(step, signals, now); });
}

void RtpuControl::go_on_ending(BoundarySignals& signals, Nanoseconds now) noexcept {
  if (!end_.go_on(signals, now)) return set_due(now + kLookWhileEnding);
  hanging_.wake_supervisor();
  set_due(now);  // due at once: the loop does not wait before it checks for the end
}

void RtpuControl::check_peers(Nanoseconds now) noexcept {
  const bool is_new = others_.adopt(tasks_, now);
  const std::uint32_t changes = others_.changes();
  if (!is_new && changes == seen_changes_) return;
  seen_changes_ = changes;
  others_.watch_flags(tasks_.flag());  // peers may have started or died
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
      waiting_.add(post);
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

bool RtpuControl::refuse_illegal(std::span<const Post> step, Nanoseconds now) noexcept {
  const auto is_illegal = [this](const Post& post) {
    const Task& task = tasks_.tasks()[post.task.index];
    if (task.standing == Standing::kHalfOn && post.signal == Signal::kOff) return false;
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
    const SignalReport done = supervised_.carry_out(signals, {&post.task, 1}, post.signal, now);
    if (done.is_deferred)
      commands_[post.task.index] = post;
    else
      report(post, done, now);
  }
}

void RtpuControl::turn_on(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept {
  FixedVector<TaskId, WaitingSignals::kMost> tasks;
  for (const Post& post : step) (void)tasks.try_push(post.task);
  const SignalReport done = supervised_.carry_out(signals, {tasks.begin(), tasks.size()}, Signal::kOn, now);
  for (const Post& post : step) {
    const State after = tasks_.tasks()[post.task.index].state;
    const Refusal why = post.task == done.task ? done.why : Refusal::kNone;
    // If false, all tasks of the step are OFF again.
    const bool goes_on = done.is_accepted || done.why == Refusal::kNotYet;
    report(post, State::kOff, after, why, goes_on && after == State::kOn, now);
  }
}

void RtpuControl::report(const Post& signal, const SignalReport& done, Nanoseconds now) noexcept {
  const bool arrived = done.is_accepted && has_arrived(done.signal, done.before, done.after);
  const Refusal why = arrived || done.why != Refusal::kNone ? done.why : Refusal::kFault;
  report(signal, done.before, done.after, why, arrived, now);
}

// Sends no report while the rtpu ends alone, because its end undoes what it carries out now. Its death answers the
// signal, and the manager asks the successor again.
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
    if (!signal.task.is_valid() || !signal.from.is_valid()) return;  // no sender waits for the report
    post.kind = PostKind::kEvent;
    post.happening = accepted ? EventKind::kSignalled : EventKind::kRefused;
    if (why == Refusal::kSwitch) post.detail = UINT32_MAX;  // the target is not known here
  }
  this->post(post);
}

// Publishes states first, so that the manager's log follows the changes that it names.
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
  if (done.why == Refusal::kSwitch) post.detail = done.set;
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

void RtpuControl::took_over(TaskId task, TaskId from, Nanoseconds after, Nanoseconds now) noexcept {
  Post post;
  post.at = now;
  post.task = task;
  post.from = from;
  post.kind = PostKind::kEvent;
  post.happening = EventKind::kTakeover;
  post.detail = static_cast<std::uint64_t>(after.count);
  this->post(post);
}

void RtpuControl::hangs(TaskWord job, Nanoseconds age, Nanoseconds used, Nanoseconds now) noexcept {
  Post post;
  post.at = now;
  post.task = job.task();
  post.kind = PostKind::kEvent;
  post.happening = EventKind::kHang;
  post.detail = static_cast<std::uint64_t>(age.count);
  post.used = static_cast<std::uint64_t>(used.count);
  this->post(post);
  others_.keep_last_words(true, tasks_);
  hanging_.note(job, age, used);
}

void RtpuControl::stop_all(BoundarySignals& signals, TaskId stopped_by, Nanoseconds now) noexcept {
  post_event(EventKind::kStop, stopped_by, 0, now);
  for (const TaskId id : spec_.end_order) {
    Task& task = tasks_.tasks()[id.index];
    if (!tasks_.is_mine(id) || task.state != State::kOn) continue;
    if (signals.may_touch(id))
      (void)supervised_.carry_out(signals, {&id, 1}, Signal::kOff, now);
    else
      tasks_.sent().defer(task, Signal::kOff);  // its job is late: `off` follows at the end of the job
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

}  // namespace chimera
