// SPDX-License-Identifier: Apache-2.0
// Reads the contexts of the other rtpus, and passes signals between them.
#include "chimera/runtime/virtual/virtual_peers.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {

Result<std::unique_ptr<VirtualPeers>> VirtualPeers::create(const ApplicationSpec& spec) {
  std::unique_ptr<VirtualPeers> made(new VirtualPeers(spec));
  for (Peer& peer : made->peers_) {
    peer.posts.reserve(kMostPosts);
    peer.flags.reserve(spec.rtpus.size());
  }
  if (auto laid = made->lay_out_operators(); !laid) return laid.error();
  return made;
}

Result<void> VirtualPeers::lay_out_operators() {
  const auto layout = PeerLayout::of(spec_, static_cast<std::uint32_t>(spec_.rtpus.size()), heap_);
  if (!layout) return layout.error();
  operators_ = *layout;
  operator_table_ = heap_.take_bytes(operators_.table().region_bytes(), kCacheLine);
  for (std::size_t o = 0; o < spec_.operators.size(); ++o) set_operator(o, spec_.operators[o].value, Nanoseconds{});
  return {};
}

void VirtualPeers::join(RtpuId rtpu, TaskSet& tasks) {
  CHIMERA_ASSERT(peers_[rtpu.index].tasks == nullptr && tasks.others() == this);
  peers_[rtpu.index].tasks = &tasks;
  show_change(rtpu);
}

State VirtualPeers::state(TaskId task) const noexcept {
  const Peer& peer = peer_of(task);
  if (peer.tasks == nullptr) return State::kNotCreated;
  const State state = peer.tasks->tasks()[task.index].shown_state();
  return peer.is_dead && state != State::kNotCreated ? State::kError : state;
}

PeerPresence VirtualPeers::presence(TaskId task) const noexcept {
  const Peer& peer = peer_of(task);
  return {!peer.is_dead, !peer.is_dead && state(task) != State::kNotCreated, peer.is_dead || peer.looked == changes_};
}

GroupReader VirtualPeers::outputs(TaskId task) const noexcept {
  const Peer& peer = peer_of(task);
  return peer.tasks == nullptr ? GroupReader() : peer.tasks->memory(task).reader();
}

GroupReader VirtualPeers::constants(TaskId task) const noexcept {
  const Peer& peer = peer_of(task);
  return peer.tasks == nullptr ? GroupReader() : peer.tasks->table().constants_of(task);
}

GroupReader VirtualPeers::operator_variable(std::size_t index) const noexcept {
  const GroupPlace& place = operators_.place(operators_.operator_group(index));
  return GroupReader(operator_table_.data() + place.offset, place.payload_bytes);
}

GroupWriter VirtualPeers::operator_writer(std::size_t index) noexcept {
  const GroupPlace& place = operators_.place(operators_.operator_group(index));
  return GroupWriter(operator_table_.subspan(place.offset, group_bytes(place.payload_bytes)), place.payload_bytes);
}

void VirtualPeers::set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept {
  GroupWriter to = operator_writer(index);
  CHIMERA_ASSERT(value.size() <= to.payload_bytes());
  std::copy(value.begin(), value.end(), to.staging());
  to.publish(now, 1);
}

bool VirtualPeers::post(Signal signal, TaskId target, TaskId, bool is_echo) noexcept {
  const RtpuId rtpu = spec_.tasks[target.index].rtpu;
  Peer& to = peers_[rtpu.index];
  if (to.is_dead || to.posts.size() == kMostPosts) return false;
  to.posts.push_back({signal, target, is_echo});
  ring(rtpu);
  return true;
}

bool VirtualPeers::take(RtpuId rtpu, VirtualPost& post) noexcept {
  Peer& peer = peers_[rtpu.index];
  if (peer.n_taken == peer.posts.size()) {
    peer.posts.clear();
    peer.n_taken = 0;
    return false;
  }
  post = peer.posts[peer.n_taken++];
  return true;
}

void VirtualPeers::show_change(RtpuId by) noexcept {
  ++changes_;
  for (std::size_t r = 0; r < peers_.size(); ++r)
    if (RtpuId(r) != by) ring(RtpuId(r));
}

bool VirtualPeers::show_raised(RtpuId rtpu, bool is_raised) noexcept {
  const std::uint32_t word = is_raised ? 1 : 0;
  return peers_[rtpu.index].raised.exchange(word, std::memory_order_relaxed) != word;
}

void VirtualPeers::raise(bool up) noexcept {
  raised_.store(up ? 1 : 0, std::memory_order_relaxed);
  show_change(RtpuId());
}

// Every context judges the part of the flag that follows from the ON tasks, and with the same result. So only the
// raised parts are passed on.
void VirtualPeers::watch_flags(RtpuId rtpu, IllegalFlag& flag) noexcept {
  Peer& me = peers_[rtpu.index];
  me.flags.assign(1, &raised_);
  for (const Peer& peer : peers_)
    if (&peer != &me && !peer.is_dead && peer.tasks != nullptr) me.flags.push_back(&peer.raised);
  flag.watch(me.flags);
}

bool VirtualPeers::is_flag_up() const noexcept {
  return std::any_of(peers_.begin(), peers_.end(), [](const Peer& peer) {
    return peer.tasks != nullptr && !peer.is_dead && peer.tasks->flag().is_up();
  });
}

void VirtualPeers::die(RtpuId rtpu, Nanoseconds now) noexcept {
  peers_[rtpu.index].is_dead = true;
  peers_[rtpu.index].died = now;
  show_change(rtpu);
}

}  // namespace chimera
