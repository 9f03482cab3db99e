// SPDX-License-Identifier: Apache-2.0
// Computes the places of the parts of a block, and reads and writes them.
#include "chimera/runtime/hosted/rtpu_block.h"

#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

#include "chimera/base/assert.h"
#include "chimera/table/shared_copy.h"

namespace chimera {

namespace {

// The goal that the manager sets for a task.
struct Wish {
  // By the manager: the store-release of BlockOwner pairs with the acquire of BlockView.
  std::atomic<std::uint32_t> goal{0};
  std::atomic<std::uint32_t> is_tapped{0};
};

static_assert(std::is_trivially_copyable_v<Profile> && sizeof(Profile) % 8 == 0);
static_assert(sizeof(BlockHead) % 64 == 0 && sizeof(PostProgress) == 8 && sizeof(Wish) == 8);
static_assert(std::is_trivially_destructible_v<SafeFrame> && alignof(SafeFrame) <= 64);
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<std::uint32_t>::is_always_lock_free);

constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t to) noexcept { return (value + to - 1) / to * to; }
constexpr std::uint64_t after(std::uint64_t begin, std::uint64_t bytes) noexcept { return begin + round_up(bytes, 64); }

// Where the parts lie from the start of the block. Parts whose size does not depend on the number of tasks come first.
constexpr std::uint64_t kMemoryAt = sizeof(BlockHead);
constexpr std::uint64_t kProgressAt = after(kMemoryAt, sizeof(ManagerMemory));
constexpr std::uint64_t kOutboxAt = after(kProgressAt, sizeof(PostProgress) * kMaxPeers);
constexpr std::uint64_t kTapAt = after(kOutboxAt, sizeof(PostRing) * kMaxPeers);
constexpr std::uint64_t kSwitchPartAt = after(kTapAt, sizeof(TapRing));
constexpr std::uint64_t kTakeoversAt = after(kSwitchPartAt, sizeof(SwitchPart));
constexpr std::uint64_t kJournalAt = after(kTakeoversAt, sizeof(TakeoverRing));
constexpr std::uint64_t kEventsAt = after(kJournalAt, kJournalBytes);
constexpr std::uint64_t kStatusAt = after(kEventsAt, kEventJournalBytes);
constexpr std::uint64_t wish_at(std::uint32_t n_tasks) noexcept {
  return after(kStatusAt, sizeof(std::uint64_t) * std::uint64_t{n_tasks});
}
constexpr std::uint64_t profile_at(std::uint32_t n_tasks) noexcept {
  return after(wish_at(n_tasks), sizeof(Wish) * std::uint64_t{n_tasks});
}

constexpr std::uint64_t safe_at(std::uint32_t n_tasks) noexcept {
  return after(profile_at(n_tasks), sizeof(Profile) * std::uint64_t{n_tasks});
}

template <class Part>
const Part& part(const std::byte* bytes, std::uint64_t at, std::uint32_t index = 0) noexcept {
  return *reinterpret_cast<const Part*>(bytes + at + sizeof(Part) * index);
}
template <class Part>
Part& part(std::byte* bytes, std::uint64_t at, std::uint32_t index = 0) noexcept {
  return *reinterpret_cast<Part*>(bytes + at + sizeof(Part) * index);
}

bool is_aligned(const std::byte* bytes) noexcept { return reinterpret_cast<std::uintptr_t>(bytes) % 64 == 0; }

using StatusWord = std::atomic<std::uint64_t>;

}  // namespace

std::uint64_t block_offset(const TableLayout& layout) noexcept { return round_up(segment_bytes(layout, 0), 4096); }

std::uint64_t block_bytes(std::uint32_t n_tasks) noexcept {
  return after(safe_at(n_tasks), sizeof(SafeFrame) * kSafeFrames * std::uint64_t{n_tasks});
}

BlockView::BlockView(const std::byte* bytes, std::uint32_t n_tasks) noexcept : bytes_(bytes), n_tasks_(n_tasks) {
  CHIMERA_ASSERT(is_aligned(bytes));
}

const BlockHead& BlockView::head() const noexcept { return part<BlockHead>(bytes_, 0); }

TaskStatus BlockView::status(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  // SYNC: pairs with the release in BlockOwner::set_status().
  return TaskStatus::of(part<StatusWord>(bytes_, kStatusAt, task.index).load(std::memory_order_acquire));
}

bool BlockView::is_status_lost(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  return !TaskStatus::is_one(part<StatusWord>(bytes_, kStatusAt, task.index).load(std::memory_order_acquire));
}

Profile BlockView::profile(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  const std::byte* from = bytes_ + profile_at(n_tasks_) + sizeof(Profile) * task.index;
  std::array<std::uint64_t, sizeof(Profile) / 8> words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = shared_copy::word(from + 8 * i).load(std::memory_order_relaxed);
  }
  Profile profile;
  std::memcpy(static_cast<void*>(&profile), words.data(), sizeof profile);
  return profile;
}

std::uint32_t BlockView::goal(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  return part<Wish>(bytes_, wish_at(n_tasks_), task.index).goal.load(std::memory_order_acquire);
}

bool BlockView::is_tapped(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  return part<Wish>(bytes_, wish_at(n_tasks_), task.index).is_tapped.load(std::memory_order_acquire) != 0;
}

const PostProgress& BlockView::progress(std::uint32_t peer) const noexcept {
  CHIMERA_ASSERT(peer < kMaxPeers);
  return part<PostProgress>(bytes_, kProgressAt, peer);
}

const PostRing& BlockView::outbox(std::uint32_t peer) const noexcept {
  CHIMERA_ASSERT(peer < kMaxPeers);
  return part<PostRing>(bytes_, kOutboxAt, peer);
}

const TapRing& BlockView::tap() const noexcept { return part<TapRing>(bytes_, kTapAt); }
const ManagerMemory& BlockView::memory() const noexcept { return part<ManagerMemory>(bytes_, kMemoryAt); }
const SwitchPart& BlockView::switch_part() const noexcept { return part<SwitchPart>(bytes_, kSwitchPartAt); }
const TakeoverRing& BlockView::takeovers() const noexcept { return part<TakeoverRing>(bytes_, kTakeoversAt); }
std::span<const std::byte> BlockView::journal() const noexcept { return {bytes_ + kJournalAt, kJournalBytes}; }
std::span<const std::byte> BlockView::event_journal() const noexcept {
  return {bytes_ + kEventsAt, kEventJournalBytes};
}
const SafeFrame& BlockView::safe_frame(TaskId task, std::uint32_t index) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_ && index < kSafeFrames);
  return part<SafeFrame>(bytes_, safe_at(n_tasks_), task.index * kSafeFrames + index);
}

BlockOwner::BlockOwner(std::byte* bytes, std::uint32_t peer, std::uint32_t incarnation, std::uint32_t n_tasks,
                       std::uint32_t n_peers) noexcept
    : bytes_(bytes), n_tasks_(n_tasks) {
  CHIMERA_ASSERT(is_aligned(bytes) && n_peers <= kMaxPeers && peer < n_peers);
  auto* head = new (bytes) BlockHead;
  head->peer = peer;
  head->incarnation = incarnation;
  head->n_tasks = n_tasks;
  head->n_peers = n_peers;
  head->magic = kBlockMagic;
  // Zeroed bytes are an empty ring, a task that is not there, no progress; but not a profile.
  for (std::uint32_t i = 0; i < n_tasks; ++i) new (&profile(TaskId{i})) Profile;
}

std::span<SafeFrame, kSafeFrames> BlockOwner::safe_frames(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  return std::span<SafeFrame, kSafeFrames>(&part<SafeFrame>(bytes_, safe_at(n_tasks_), task.index * kSafeFrames),
                                           kSafeFrames);
}

BlockHead& BlockOwner::head() const noexcept { return part<BlockHead>(bytes_, 0); }

void BlockOwner::set_status(TaskId task, TaskStatus status) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  part<StatusWord>(bytes_, kStatusAt, task.index).store(status.word(), std::memory_order_release);
}

Profile& BlockOwner::profile(TaskId task) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  return part<Profile>(bytes_, profile_at(n_tasks_), task.index);
}

void BlockOwner::set_goal(TaskId task, std::uint32_t goal) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  part<Wish>(bytes_, wish_at(n_tasks_), task.index).goal.store(goal, std::memory_order_release);
}

void BlockOwner::set_tapped(TaskId task, bool tapped) const noexcept {
  CHIMERA_ASSERT(task.index < n_tasks_);
  part<Wish>(bytes_, wish_at(n_tasks_), task.index).is_tapped.store(tapped ? 1 : 0, std::memory_order_release);
}

PostProgress& BlockOwner::progress(std::uint32_t peer) const noexcept {
  CHIMERA_ASSERT(peer < kMaxPeers);
  return part<PostProgress>(bytes_, kProgressAt, peer);
}

PostRing& BlockOwner::outbox(std::uint32_t peer) const noexcept {
  CHIMERA_ASSERT(peer < kMaxPeers);
  return part<PostRing>(bytes_, kOutboxAt, peer);
}

TapRing& BlockOwner::tap() const noexcept { return part<TapRing>(bytes_, kTapAt); }
ManagerMemory& BlockOwner::memory() const noexcept { return part<ManagerMemory>(bytes_, kMemoryAt); }
SwitchPart& BlockOwner::switch_part() const noexcept { return part<SwitchPart>(bytes_, kSwitchPartAt); }
TakeoverRing& BlockOwner::takeovers() const noexcept { return part<TakeoverRing>(bytes_, kTakeoversAt); }
std::span<std::byte> BlockOwner::journal() const noexcept { return {bytes_ + kJournalAt, kJournalBytes}; }
std::span<std::byte> BlockOwner::event_journal() const noexcept { return {bytes_ + kEventsAt, kEventJournalBytes}; }

}  // namespace chimera
