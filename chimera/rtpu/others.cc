// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/others.h"

#include <cstring>
#include <utility>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

constexpr std::uint32_t kFlagIllegalSet = 1, kFlagRaised = 2;

}  // namespace

Others::Others(const ApplicationSpec& spec, std::uint32_t me, std::span<std::byte> segment, BlockOwner block,
               DecisionPage& decision, const KeeperPage& keeper, MappedPeers& peers)
    : spec_(&spec), me_(me), segment_(segment), block_(block), decision_(&decision), keeper_(&keeper), peers_(&peers),
      faults_(spec.tasks.size()), notes_(spec.tasks.size()), inboxes_(peers.count()), is_read_(peers.count()) {
  for (std::uint32_t peer = 0; peer < peers.count(); ++peer)
    outboxes_.emplace_back(block_.outbox(peer), nullptr, block_.head().incarnation);
  flags_.reserve(peers.count());
}

bool Others::lives(std::uint32_t peer) const noexcept {
  const PeerSegment* mapped = peers_->at(peer);
  return mapped != nullptr && keeper_->alive[peer].load(std::memory_order_acquire) == mapped->incarnation();
}

State Others::state(TaskId task) const noexcept {
  const std::uint32_t peer = spec_->tasks[task.index].rtpu.index;
  const PeerSegment* mapped = peers_->at(peer);
  if (mapped == nullptr) return State::kNotCreated;
  const TaskStatus status = mapped->block().status(task);
  if (!lives(peer)) return status.state == State::kNotCreated ? State::kNotCreated : State::kError;
  return status.in_service && status.state == State::kOn ? State::kOff : status.state;
}

GroupReader Others::group(std::uint32_t peer, GroupId id) const noexcept {
  const PeerSegment* mapped = peers_->at(peer);
  return mapped == nullptr ? GroupReader() : mapped->group(id);
}

GroupReader Others::outputs(TaskId task) const noexcept {
  const std::uint32_t peer = spec_->tasks[task.index].rtpu.index;
  const PeerSegment* mapped = peers_->at(peer);
  if (mapped == nullptr) return {};
  return group(peer, peers_->layout(peer).outputs(task, mapped->block().status(task).incarnation));
}

GroupReader Others::constants(TaskId task) const noexcept {
  const std::uint32_t peer = spec_->tasks[task.index].rtpu.index;
  return group(peer, peers_->layout(peer).constants(task));
}

GroupReader Others::operator_variable(std::size_t index) const noexcept {
  return group(manager(), peers_->layout(manager()).operator_group(index));
}

bool Others::post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept {
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

std::uint32_t Others::flag_word() const noexcept {
  return (tasks_->is_on_set_legal() ? 0 : kFlagIllegalSet) | (tasks_->is_flag_raised() ? kFlagRaised : 0);
}

void Others::changed() noexcept {
  if (tasks_ == nullptr || keeps_last_words_) return;  // set-up; the last words are said
  bool any = false;
  for (const Task& task : tasks_->tasks()) {
    if (!tasks_->is_mine(task.id)) continue;
    const TaskStatus before = block_.view().status(task.id);
    const TaskStatus now{task.state, task.in_service, tasks_->incarnation(task.id)};
    if (now == before) continue;
    block_.set_status(task.id, now);
    any = true;
    if (now.state == before.state) continue;
    Post post;
    post.at = {task.call.now_ns};
    post.task = task.id;
    post.kind = PostKind::kEvent;
    post.happening = Happening::kState;
    post.before = before.state;
    post.after = now.state;
    tell(post);
  }
  const std::uint32_t before = block_.head().flag.load(std::memory_order_relaxed);
  // Whoever ends raises no flag any more: what its tasks lack is what was told to go.
  const std::uint32_t flag = is_told_to_end() ? flag_word() & before : flag_word();
  if (before != flag) {
    block_.head().flag.store(flag, std::memory_order_release);
    Post post;
    post.at = LinuxClock().now();
    post.from = tasks_->raised_by();
    post.kind = PostKind::kEvent;
    post.happening = Happening::kFlag;
    post.detail = flag;
    tell(post);
    any = true;
  }
  watch_flags();
  if (!any) return;
  decision_->changes.fetch_add(1, std::memory_order_release);  // pairs with changes(): the words above are seen
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer)
    if (peer != me_) ring(peer);
}

void Others::keep_last_words(bool keeps) noexcept {
  if (std::exchange(keeps_last_words_, keeps) && !keeps) changed();
}

// The flags of those who live; that of the manager also while it is being restarted.
void Others::watch_flags() noexcept {
  flags_.clear();
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer) {
    const PeerSegment* mapped = peer == me_ ? nullptr : peers_->at(peer);
    if (mapped != nullptr && (peer == manager() || lives(peer))) flags_.push_back(&mapped->block().head().flag);
  }
  tasks_->watch_flags(flags_);
}

void Others::told(const Task& task) noexcept {
  const PeerLayout& layout = peers_->layout(me_);
  const GroupPlace& place = layout.place(layout.fault(task.id));
  GroupWriter writer(segment_.subspan(sizeof(SegmentHeader) + place.offset, group_bytes(place.payload_bytes)),
                     place.payload_bytes);
  std::memcpy(writer.staging(), &task.faults, sizeof task.faults);
  writer.publish(task.faults.at, 1);
  if (std::exchange(faults_[task.id.index], task.faults.count) != task.faults.count)
    tell(Happening::kFault, task.id, static_cast<std::uint64_t>(task.faults.method), task.faults.at);
  if (std::exchange(notes_[task.id.index], task.faults.notes) != task.faults.notes)
    tell(Happening::kNote, task.id, 0, LinuxClock().now());
}

bool Others::adopt() noexcept {
  bool any = false;
  let_go_unread();
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer) {
    if (peer == me_ || is_read_[peer] || !peers_->adopt(peer)) continue;
    any = true;
    const PeerSegment& mapped = *peers_->at(peer);
    outboxes_[peer].set_reader(&mapped.block().progress(me_));
    inboxes_[peer] = Inbox(mapped.block().outbox(me_), block_.progress(peer), mapped.incarnation());
    if (peer == manager()) tasks_->let_go(TaskId());
    for (const TaskSpec& task : spec_->tasks)
      if (task.rtpu.index == peer) tasks_->let_go(TaskId(static_cast<std::size_t>(&task - spec_->tasks.data())));
    watch_flags();
    is_read_[peer] = true;
  }
  let_go_unread();
  return any;
}

void Others::let_go_unread() noexcept {
  if (tasks_->is_any_behind()) return;
  for (std::uint32_t peer = 0; peer < peers_->count(); ++peer) {
    if (is_read_[peer]) peers_->let_go(peer);
    is_read_[peer] = false;
  }
}

bool Others::take(Post& post) noexcept {
  for (Inbox& inbox : inboxes_)
    if (inbox.is_attached() && inbox.take(post)) return true;
  return false;
}

void Others::tell(const Post& post) noexcept {
  if (outboxes_[manager()].is_followed() && outboxes_[manager()].try_post(post)) ring(manager());
  else block_.head().lost_posts.fetch_add(1, std::memory_order_relaxed);
}

void Others::tell(Happening happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept {
  Post post;
  post.at = at;
  post.task = task;
  post.kind = PostKind::kEvent;
  post.happening = happening;
  post.detail = detail;
  tell(post);
}

}  // namespace chimera
