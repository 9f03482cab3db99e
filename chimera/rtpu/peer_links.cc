// SPDX-License-Identifier: Apache-2.0
// Publishes the changes of this rtpu to other processes, and reads theirs.
#include "chimera/rtpu/peer_links.h"

#include <cstring>
#include <utility>

namespace chimera {
namespace {

constexpr std::uint32_t kFlagIllegalSet = 1, kFlagRaised = 2;

GroupReader group_of(const PeerSegment* mapped, GroupId id) noexcept {
  return mapped == nullptr ? GroupReader() : mapped->group(id);
}

}  // namespace

PeerLinks::PeerLinks(const ApplicationSpec& spec, std::uint32_t me, std::span<std::byte> segment, BlockOwner block,
                     DecisionPage& decision, const KeeperPage& keeper, MappedPeers& peers)
    : spec_(&spec),
      me_(me),
      segment_(segment),
      block_(block),
      decision_(&decision),
      keeper_(&keeper),
      now_(keeper.origin),
      peers_(&peers),
      claims_(decision, keeper, me, block_.head().incarnation),
      faults_(spec.tasks.size()),
      notes_(spec.tasks.size()),
      inboxes_(peers.count()),
      is_read_(peers.count()) {
  for (std::uint32_t peer = 0; peer < peers.count(); ++peer)
    outboxes_.emplace_back(block_.outbox(peer), nullptr, block_.head().incarnation);
  flags_.reserve(peers.count());
}

const PeerSegment* PeerLinks::at(std::uint32_t peer) const noexcept {
  const PeerSegment* mapped = peers_->at(peer);
  const std::uint32_t alive = keeper_->alive[peer].load(std::memory_order_acquire);
  return mapped != nullptr && alive == mapped->incarnation() ? mapped : nullptr;
}

State PeerLinks::state(TaskId task) const noexcept {
  const std::uint32_t peer = spec_->tasks[task.index].rtpu.index;
  const PeerSegment* mapped = peers_->at(peer);
  if (mapped == nullptr) return State::kNotCreated;
  const TaskStatus status = mapped->block().status(task);
  if (at(peer) == nullptr) return status.state == State::kNotCreated ? State::kNotCreated : State::kError;
  return status.in_service && status.state == State::kOn ? State::kOff : status.state;
}

PeerPresence PeerLinks::presence(TaskId task) const noexcept {
  const PeerSegment* const there = at(spec_->tasks[task.index].rtpu.index);
  if (there == nullptr) return {};
  const TaskStatus status = there->block().status(task);
  const std::uint32_t seen = there->block().head().seen_changes.load(std::memory_order_acquire);
  return {true, status.state != State::kNotCreated || status.in_service,
          static_cast<std::int32_t>(seen - last_shown_) >= 0};
}

GroupReader PeerLinks::outputs(TaskId task) const noexcept {
  const std::uint32_t peer = spec_->tasks[task.index].rtpu.index;
  const PeerSegment* mapped = peers_->at(peer);
  if (mapped == nullptr) return {};
  return mapped->group(peers_->layout(peer).outputs(task, mapped->block().status(task).incarnation));
}

GroupReader PeerLinks::constants(TaskId task) const noexcept {
  const std::uint32_t peer = spec_->tasks[task.index].rtpu.index;
  return group_of(peers_->at(peer), peers_->layout(peer).constants(task));
}

GroupReader PeerLinks::operator_variable(std::size_t index) const noexcept {
  return group_of(peers_->at(manager()), peers_->layout(manager()).operator_group(index));
}

bool PeerLinks::post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept {
  Post post;
  post.task = target;
  post.from = from;
  post.signal = signal;
  post.kind = signal == Signal::kOn ? PostKind::kRequest : PostKind::kSignal;
  post.detail = is_echo ? 1 : 0;
  const std::uint32_t peer = signal == Signal::kOn ? manager() : spec_->tasks[target.index].rtpu.index;
  if (!outboxes_[peer].is_followed() || !outboxes_[peer].try_post(post)) return false;
  ring(peer);
  return true;
}

void PeerLinks::publish(TaskSet& tasks) noexcept {
  bool is_for_all = false;
  for (const Change& change : tasks.changes().list()) {
    if (change.kind == Change::Kind::kFault) publish_fault(tasks.tasks()[change.task.index]);
    if (keeps_last_words_) continue;
    if (change.kind == Change::Kind::kStatus)
      is_for_all |= publish_status(tasks.tasks()[change.task.index], change.before, change.now);
    if (change.kind == Change::Kind::kFlag) is_for_all |= publish_flag(tasks.flag());
  }
  tasks.changes().clear();
  claims_.give_back();
  if (is_for_all) ring_all();
}

void PeerLinks::publish_all(TaskSet& tasks) noexcept {
  publish(tasks);
  bool is_for_all = publish_flag(tasks.flag());
  for (const Task& task : tasks.tasks()) {
    if (!tasks.is_mine(task.id)) continue;
    const TaskStatus now{task.state, task.in_service(), tasks.memory(task.id).incarnation()};
    is_for_all |= publish_status(task, block_.view().status(task.id), now);
  }
  if (is_for_all) ring_all();
}

// True if the other processes must read the change.
bool PeerLinks::publish_status(const Task& task, TaskStatus before, TaskStatus now) noexcept {
  if (now == before) return false;
  block_.set_status(task.id, now);
  if (now.state == before.state) return true;
  Post post;
  post.at = {task.call.now_ns};
  post.task = task.id;
  post.kind = PostKind::kEvent;
  post.happening = EventKind::kState;
  post.before = before.state;
  post.after = now.state;
  send(post);
  return true;
}

bool PeerLinks::publish_flag(const IllegalFlag& flag) noexcept {
  const bool is_raised = flag.is_raised() || flag.is_held();
  const std::uint32_t judged = (flag.is_on_set_legal() ? 0 : kFlagIllegalSet) | (is_raised ? kFlagRaised : 0);
  const std::uint32_t before = block_.head().flag.load(std::memory_order_relaxed);
  // While the run ends, this rtpu raises no flag: the missing tasks were ended on purpose.
  const bool is_told_to_end = keeper_->ending.load(std::memory_order_acquire) != 0;
  const std::uint32_t now = is_told_to_end ? judged & before : judged;
  if (before == now) return false;
  block_.head().flag.store(now, std::memory_order_release);  // BlockHead
  Post post;
  post.at = now_;
  post.from = flag.raised_by();
  post.kind = PostKind::kEvent;
  post.happening = EventKind::kFlag;
  post.detail = now;
  send(post);
  return true;
}

void PeerLinks::publish_fault(const Task& task) noexcept {
  const PeerLayout& layout = peers_->layout(me_);
  const GroupPlace& place = layout.place(layout.fault(task.id));
  GroupWriter writer(segment_.subspan(sizeof(SegmentHeader) + place.offset, group_bytes(place.payload_bytes)),
                     place.payload_bytes);
  std::memcpy(writer.staging(), &task.faults, sizeof task.faults);
  writer.publish(task.faults.at, 1);
  if (std::exchange(faults_[task.id.index], task.faults.count) != task.faults.count)
    send_event(EventKind::kFault, task.id, static_cast<std::uint64_t>(task.faults.method), task.faults.at);
  if (std::exchange(notes_[task.id.index], task.faults.notes) != task.faults.notes)
    send_event(EventKind::kNote, task.id, 0, now_);
}

void PeerLinks::ring_all() noexcept {
  // Release pairs with changes(): a reader of the count sees the words written before.
  last_shown_ = 1 + decision_->changes.fetch_add(1, std::memory_order_release);
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer)
    if (peer != me_) ring(peer);
}

void PeerLinks::keep_last_words(bool keeps, TaskSet& tasks) noexcept {
  if (std::exchange(keeps_last_words_, keeps) && !keeps) publish_all(tasks);
}

void PeerLinks::watch_flags(IllegalFlag& flag) noexcept {
  flags_.clear();
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer) {
    const PeerSegment* mapped = peer == me_ ? nullptr : peers_->at(peer);
    if (mapped != nullptr && (peer == manager() || at(peer) != nullptr)) flags_.push_back(&mapped->block().head().flag);
  }
  flag.watch(flags_);
}

bool PeerLinks::adopt(TaskSet& tasks, Nanoseconds now) noexcept {
  now_ = now;
  bool any = false;
  let_go_unread(tasks.sources());
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer) {
    if (peer == me_ || is_read_[peer] || !peers_->adopt(peer)) continue;
    any = true;
    const PeerSegment& mapped = *peers_->at(peer);
    outboxes_[peer].set_reader(&mapped.block().progress(me_));
    inboxes_[peer] = Inbox(mapped.block().outbox(me_), block_.progress(peer), mapped.incarnation());
    if (peer == manager()) tasks.sources().let_go(TaskId());
    for (std::size_t t = 0; t < spec_->tasks.size(); ++t)
      if (spec_->tasks[t].rtpu.index == peer) tasks.sources().let_go(TaskId(t));
    watch_flags(tasks.flag());
    is_read_[peer] = true;
  }
  let_go_unread(tasks.sources());
  return any;
}

void PeerLinks::let_go_unread(const Sources& sources) noexcept {
  if (sources.is_any_behind()) return;
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer) {
    if (is_read_[peer]) peers_->release_mapping(peer);
    is_read_[peer] = false;
  }
}

bool PeerLinks::pop(Post& post) noexcept {
  for (Inbox& inbox : inboxes_)
    if (inbox.is_attached() && inbox.take(post)) return true;
  return false;
}

void PeerLinks::send(const Post& post) noexcept {
  if (outboxes_[manager()].is_followed() && outboxes_[manager()].try_post(post))
    ring(manager());
  else
    block_.head().lost_posts.fetch_add(1, std::memory_order_relaxed);
}

void PeerLinks::send_event(EventKind happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept {
  Post post;
  post.at = at;
  post.task = task;
  post.kind = PostKind::kEvent;
  post.happening = happening;
  post.detail = detail;
  send(post);
}

}  // namespace chimera
