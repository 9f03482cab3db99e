// SPDX-License-Identifier: Apache-2.0
// Maps the segments of rtpus, reads their state and messages, and sends them signals.
#include "chimera/manager/act/rtpu_links.h"

#include <utility>

#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/state/cause.h"
#include "chimera/manager/state/credible.h"
#include "chimera/manager/state/post_text.h"
#include "chimera/manager/state/unfinished.h"
#include "chimera/manager/switch/switch_coordinator.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/hosted/making_text.h"
#include "chimera/runtime/making.h"
#include "chimera/text/not_off.h"

namespace chimera::manager {

RtpuLinks::RtpuLinks(ManagerState& state)
    : state_(state), links_(state.peers.n_rtpus()), seen_(state.peers.n_tasks()), counted_(state.peers.n_tasks()) {
  for (std::uint32_t t = 0; t < state.peers.n_tasks(); ++t)
    links_[state.spec().tasks[t].rtpu.index].tasks.push_back(TaskId(t));
}

bool RtpuLinks::is_current(RtpuId rtpu) const noexcept {
  const PeerSegment& segment = state_.peers[rtpu];
  return segment.is_there() && segment.incarnation() == state_.rtpus[rtpu.index].incarnation;
}

// Something in the words of the rtpu that the rtpu would not write; "" if there is nothing.
std::string RtpuLinks::wrong_word(RtpuId rtpu) const {
  const PeerSegment& segment = state_.peers[rtpu];
  if (const auto whole = segment.check(); !whole) return std::string(whole.error().message.view());
  const BlockHead& head = segment.block().head();
  if (head.phase.load(std::memory_order_relaxed) > PeerPhase::kEnded) return "its phase";
  if (head.lost_posts > most_in(now() - state_.keeper.origin)) return "its lost events";
  for (const TaskId task : links_[rtpu.index].tasks)
    if (segment.block().is_status_lost(task)) return "the state of " + state_.name(task);
  return "";
}

std::string RtpuLinks::wrong_count(RtpuId rtpu, Nanoseconds at) const {
  for (const TaskId task : links_[rtpu.index].tasks) {
    if (!is_credible(state_.peers[rtpu].block().profile(task), at - state_.keeper.origin))
      return "the counters of " + state_.name(task);
    if (!is_credible(state_.peers.fault(task), state_.keeper.origin, at))
      return "the last fault of " + state_.name(task);
  }
  return "";
}

// False if there is no memory of the present incarnation, or something has overwritten it. Call it after a word was
// read and before it is used: the memory may be overwritten at any time, its head first.
bool RtpuLinks::believes(RtpuId rtpu) {
  if (!is_current(rtpu)) return false;
  const std::string wrong = wrong_word(rtpu);
  if (!wrong.empty()) disbelieve(rtpu, wrong);
  return wrong.empty();
}

// Nothing in the memory of the rtpu is read any more. RtpuWatch has a living one killed.
void RtpuLinks::disbelieve(RtpuId rtpu, std::string_view why) {
  RtpuRecord& record = this->record(rtpu);
  links_[rtpu.index].inbox = {};  // both point into the mapping that ends
  links_[rtpu.index].outbox = {};
  state_.peers.forget(rtpu);
  record.is_overwritten = true;
  record.is_up = false;
  record.is_away = record.is_alive;
  state_.tell("fault", TaskId{}, rtpu,
              "something in it has overwritten its memory (" + std::string(why) + ")" +
                  (record.is_alive ? ": its states and numbers are not shown, and it is ended" : ""),
              now());
}

// True if another serving rtpu has not finished the last switch. Tasks that come back now could conflict with the steps
// that it must undo.
bool RtpuLinks::is_switch_open_beside(RtpuId rtpu) const noexcept {
  const std::uint16_t number = PlanWord::of(state_.page.switching.plan.load(std::memory_order_acquire)).number;
  for (std::uint32_t r = 0; number != 0 && r < links_.size(); ++r) {
    if (r == rtpu.index || !state_.rtpus[r].is_alive || !is_current(RtpuId(r))) continue;
    const BlockHead& head = state_.peers[RtpuId(r)].block().head();
    const bool serves = state_.rtpus[r].is_up || head.phase.load(std::memory_order_acquire) == PeerPhase::kServing;
    const SwitchProgress& progress = head.switching;
    if (serves && progress.over.load(std::memory_order_acquire) != number) return true;  // SwitchProgress
  }
  return false;
}

void RtpuLinks::started(const KeeperMessage& message) {
  if (message.index >= links_.size()) return;
  RtpuRecord& rtpu = record(RtpuId(message.index));
  rtpu.pid = message.pid;
  rtpu.incarnation = message.incarnation;
  rtpu.restarts = message.incarnation - 1;
  rtpu.is_alive = true;
  rtpu.is_up = rtpu.is_away = rtpu.is_overwritten = false;
  rtpu.hang.clear();
  rtpu.ended_for.clear();
}

void RtpuLinks::mapped(const KeeperMessage& message, int descriptor) {
  const RtpuId rtpu(message.index);
  Link& link = links_[rtpu.index];
  link.inbox = {};  // both point into the mapping that ends
  link.outbox = {};
  if (const auto mapped = state_.peers.map(rtpu, message.incarnation, descriptor); !mapped) {
    const Error& why = mapped.error();
    if (why.code == ErrorCode::kBadInput) return disbelieve(rtpu, why.message.view());
    std::string text = "its memory cannot be read (" + std::string(why.message.view()) + ")";
    if (record(rtpu).is_alive)
      text += ": the manager cannot send commands to it; `kill -KILL " + std::to_string(record(rtpu).pid) +
              "` restarts it";
    state_.tell("fault", TaskId{}, rtpu, std::move(text), now());
    return;
  }
  const BlockView& block = state_.peers[rtpu].block();
  const BlockOwner& own = state_.own.block();
  link.inbox = Inbox::resume(block.outbox(state_.own.peer()), own.progress(rtpu.index), message.incarnation);
  link.outbox = Outbox(own.outbox(rtpu.index), &block.progress(state_.own.peer()), state_.own.incarnation());
  // A restarted rtpu may have died in a switch that is over or being undone. Only a predecessor knew, so this manager
  // assumes it.
  const bool is_open = PlanWord::of(state_.page.switching.plan.load(std::memory_order_acquire)).is_open();
  if (own.head().incarnation > 1 && message.incarnation > 1 && !is_open) link.has_died = true;
  // A predecessor may have died before it logged the loss. Twice in the log is better than never.
  link.lost = own.head().incarnation > 1 ? 0 : block.head().lost_posts.load();
  for (const TaskId task : link.tasks) {
    const Profile p = block.profile(task);
    counted_[task.index] = {p.missed, p.overrun, p.stale};
  }
  // Rings its bell, so that the rtpu checks if it can serve this manager.
  Doorbell(state_.page.bells[rtpu.index].word).ring();
}

void RtpuLinks::ended(const KeeperMessage& message, Events& events) {
  if (message.index >= links_.size()) return;
  const RtpuId rtpu(message.index);
  RtpuRecord& record = this->record(rtpu);
  record.incarnation = message.incarnation;
  record.restarts = message.incarnation - 1;
  const bool left_words = believes(rtpu);
  const bool is_known = message.incarnation <= state_.own.block().memory().handled[rtpu.index];  // by a predecessor
  if (left_words) take_posts(rtpu, events);
  if (left_words || !is_known) {
    abort_open_plan_of(state_, rtpu);
    links_[rtpu.index].has_died = true;
  }
  for (const TaskId task : links_[rtpu.index].tasks) {
    if (!left_words && is_known) continue;
    if (left_words) seen_[task.index] = state_.peers.status(task);
    const TaskStatus last = left_words ? last_status(state_, task) : state_.own.block().view().status(task);
    events.push_back(subsystem::TaskSeen{task, last});
  }
  record.is_alive = record.is_up = record.is_away = false;
  record.hang.clear();
  const BlockView left = left_words ? state_.peers[rtpu].block() : BlockView();
  record.last_end = cause_text(state_.spec(), message, left,
                               record.is_overwritten ? "with its memory overwritten" : what_it_made(rtpu));
  if (!record.ended_for.empty()) record.last_end += ": " + std::exchange(record.ended_for, "");
  if (left_words && !is_known)
    for (const Unfinished& one : unfinished(state_, rtpu, left, record.last_end))
      state_.tell("not-off", one.task, rtpu, one.text, message.at);
  const bool is_end = state_.is_ending();
  const bool is_orderly = left_words && left.head().phase == PeerPhase::kEnded;
  events.push_back(subsystem::RtpuDown{rtpu, message.incarnation, record.last_end, is_end, is_orderly});
}

/// The object or task that an rtpu without a block was loading or constructing.
std::string RtpuLinks::what_it_made(RtpuId rtpu) const {
  const std::uint32_t word = state_.page.making[rtpu.index];
  const std::uint32_t task = task_of_making(word, state_.spec().tasks.size());
  if (task == UINT32_MAX) return {};
  const TaskSpec& spec = state_.spec().tasks[task];
  const LibraryEntry* entry = state_.bundle.library.find(spec.component);
  return making_text(word, spec.name, entry == nullptr ? std::string(spec.component) : entry->object_file);
}

bool RtpuLinks::all_up() const noexcept {
  for (const RtpuRecord& rtpu : state_.rtpus)
    if (rtpu.is_alive && !rtpu.is_up) return false;
  return true;
}

void RtpuLinks::look(Events& events) {
  for (std::uint32_t r = 0; r < links_.size(); ++r) {
    const RtpuId rtpu(r);
    RtpuRecord& record = this->record(rtpu);
    if (!record.is_alive || !believes(rtpu)) continue;
    const PeerPhase phase = state_.peers[rtpu].block().head().phase.load(std::memory_order_acquire);
    const bool waits = links_[r].has_died && is_switch_open_beside(rtpu);
    const bool rises = !record.is_up && phase == PeerPhase::kServing && links_[r].outbox.is_followed() && !waits;
    take_posts(rtpu, events);
    if (record.is_up || rises)
      for (const TaskId task : links_[r].tasks) see(task, events, rises);
    if (!rises || record.is_overwritten) continue;
    record.is_up = true;
    links_[r].has_died = false;
    events.push_back(subsystem::RtpuUp{rtpu, record.incarnation});
  }
}

void RtpuLinks::see(TaskId task, Events& events, bool always) {
  const TaskStatus status = state_.peers.status(task);
  if (!always && status == seen_[task.index]) return;
  if (!believes(state_.spec().tasks[task.index].rtpu)) return;
  seen_[task.index] = status;
  state_.own.block().set_status(task, status);
  events.push_back(subsystem::TaskSeen{task, status});
}

void RtpuLinks::take_posts(RtpuId rtpu, Events& events) {
  Post post;
  for (std::size_t n = 0; n < 4 * kPosts && links_[rtpu.index].inbox.take(post); ++n) take(post, rtpu, events);
}

void RtpuLinks::take(const Post& post, RtpuId rtpu, Events& events) {
  const bool is_its = post.task.index < seen_.size() && state_.spec().tasks[post.task.index].rtpu == rtpu;
  if (post.kind == PostKind::kEvent) return log(post, rtpu);
  if (post.kind == PostKind::kRequest && post.task.index < seen_.size()) {
    events.push_back(subsystem::Requested{post.task, post.signal, post.from});
  } else if (post.kind == PostKind::kReport && is_its) {
    see(post.task, events);
    const auto why = static_cast<Refusal>(post.why);
    events.push_back(subsystem::Reported{post.command, post.task, post.signal, post.detail == 1, why, post.before,
                                         post.after, why == Refusal::kFault ? fault_text(state_, post.task) : ""});
  }
}

void RtpuLinks::log(const Post& post, RtpuId rtpu) {
  const bool has_task = post.task.index < seen_.size();
  std::string words;
  if (has_task && post.happening == EventKind::kNote)
    words = state_.fault(post.task).note;
  else if (has_task)
    words = fault_text(state_, post.task);
  std::string text = event_text(state_.spec(), post, words);
  const bool is_illegal_set = post.happening == EventKind::kFlag && (post.detail & 1u) != 0;
  if (const std::string missing = is_illegal_set ? state_.logic.missing() : ""; !missing.empty())
    text += ": " + missing;
  state_.tell(event_kind(post.happening), has_task ? post.task : TaskId{}, rtpu, std::move(text), post.at);
  const auto method = static_cast<Method>(post.detail);
  if (has_task && post.happening == EventKind::kFault && turns_off(method))
    tell_not_off(post.task, method, rtpu, post.at);
}

void RtpuLinks::tell_not_off(TaskId task, Method method, RtpuId rtpu, Nanoseconds at) {
  const FaultRecord fault = state_.fault(task);
  const char* words = fault.method == method ? fault.last.text : "its text was replaced by that of a later fault";
  state_.tell("not-off", task, rtpu, not_off_text(method, words), at);
}

void RtpuLinks::look_at_counters(Nanoseconds at) {
  for (std::uint32_t r = 0; r < links_.size(); ++r) {
    if (!state_.peers[RtpuId(r)].is_there()) continue;
    if (const std::string wrong = wrong_count(RtpuId(r), at); !wrong.empty()) {
      disbelieve(RtpuId(r), wrong);
      continue;
    }
    for (const TaskId task : links_[r].tasks) count(task, at);
    const std::uint64_t lost = state_.peers[RtpuId(r)].block().head().lost_posts;
    if (lost > links_[r].lost && wrong_word(RtpuId(r)).empty())
      state_.tell("lost", TaskId{}, RtpuId(r), tally("event", "lost for lack of room", lost - links_[r].lost, lost),
                  at);
    links_[r].lost = lost;
  }
}

void RtpuLinks::count(TaskId task, Nanoseconds at) {
  const Profile p = state_.profile(task);
  Counted& before = counted_[task.index];
  const RtpuId rtpu = state_.spec().tasks[task.index].rtpu;
  if (p.missed > before.missed)
    state_.tell("miss", task, rtpu, tally("deadline", "missed", p.missed - before.missed, p.missed), at);
  if (p.overrun > before.overrun)
    state_.tell("overrun", task, rtpu, tally("cycle", "over budget", p.overrun - before.overrun, p.overrun), at);
  if (p.stale > before.stale)
    state_.tell("stale", task, rtpu, tally("input", "kept stale", p.stale - before.stale, p.stale), at);
  before = {p.missed, p.overrun, p.stale};
}

bool RtpuLinks::has_room(RtpuId rtpu, std::size_t posts) const noexcept {
  const Outbox& outbox = links_[rtpu.index].outbox;
  return state_.rtpus[rtpu.index].is_alive && outbox.is_followed() && outbox.room() >= posts;
}

RtpuId RtpuLinks::ring(std::span<const TaskId> tasks, Nanoseconds at) {
  std::vector<std::size_t> posts(links_.size());
  for (const TaskId task : tasks) ++posts[state_.spec().tasks[task.index].rtpu.index];
  for (std::size_t r = 0; r < posts.size(); ++r)
    if (posts[r] > 0 && !has_room(RtpuId(r), posts[r])) return RtpuId(r);
  for (const TaskId task : tasks) {
    Post post;
    post.at = at;
    post.task = task;
    post.signal = Signal::kWakeup;
    (void)links_[state_.spec().tasks[task.index].rtpu.index].outbox.try_post(post);  // there is room
  }
  for (std::size_t r = 0; r < posts.size(); ++r)
    if (posts[r] > 0) Doorbell(state_.page.bells[r].word).ring();
  return {};
}

bool RtpuLinks::send(const subsystem::Send& send, Nanoseconds at) {
  Outbox& outbox = links_[send.rtpu.index].outbox;
  if (!has_room(send.rtpu, send.tasks.size())) return false;
  for (std::size_t i = 0; i < send.tasks.size(); ++i) {
    Post post;
    post.command = send.command;
    post.at = at;
    post.task = send.tasks[i];
    post.signal = send.signal;
    post.more = i + 1 < send.tasks.size();
    if (!outbox.try_post(post)) return false;  // cannot happen: there was room, and only this process writes
  }
  Doorbell(state_.page.bells[send.rtpu.index].word).ring();
  return true;
}

}  // namespace chimera::manager
