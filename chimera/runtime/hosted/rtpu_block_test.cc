// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/rtpu_block.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

namespace chimera {
namespace {

struct FreeBytes {
  void operator()(std::byte* bytes) const { ::operator delete[](bytes, std::align_val_t{64}); }
};
using Bytes = std::unique_ptr<std::byte[], FreeBytes>;

// Exactly as many bytes as asked for: one too far is caught by the address sanitizer.
Bytes zeroed(std::uint64_t n) {
  Bytes bytes(new (std::align_val_t{64}) std::byte[n]);
  std::memset(bytes.get(), 0, n);
  return bytes;
}

TEST(RtpuBlock, LiesBehindTheGroupsOnAPageOfItsOwn) {
  const VariableSpec variables[] = {{"x", 8, 700}};
  const GroupSpec groups[] = {{"task", variables}};
  GroupPlace group_places[1];
  VariablePlace variable_places[1];
  const auto layout = TableLayout::plan(groups, 1 << 20, group_places, variable_places);
  ASSERT_TRUE(layout);
  EXPECT_EQ(block_offset(*layout) % 4096, 0u);
  EXPECT_GE(block_offset(*layout), segment_bytes(*layout, 0));
  EXPECT_LT(block_offset(*layout), segment_bytes(*layout, 0) + 4096);
  EXPECT_EQ(peer_segment_bytes(*layout, 3), block_offset(*layout) + block_bytes(3));
}

TEST(RtpuBlock, AViewReadsTheStatusOfTheOwner) {
  const Bytes bytes = zeroed(block_bytes(3));
  const BlockOwner owner(bytes.get(), 1, 5, 3, 4);
  const BlockView view(bytes.get(), 3);
  EXPECT_EQ(view.head().magic, kBlockMagic);
  EXPECT_EQ(view.head().peer, 1u);
  EXPECT_EQ(view.head().incarnation, 5u);
  EXPECT_EQ(view.head().n_tasks, 3u);
  EXPECT_EQ(view.head().n_peers, 4u);
  EXPECT_EQ(view.status(TaskId{2u}), TaskStatus{});
  owner.set_status(TaskId{2u}, {State::kOn, true, 9});
  EXPECT_EQ(view.status(TaskId{2u}), (TaskStatus{State::kOn, true, 9}));
  EXPECT_EQ(view.status(TaskId{1u}), TaskStatus{});
  owner.profile(TaskId{1u}).execution[CHIMERA_CYCLE].add(microseconds(3));
  owner.profile(TaskId{1u}).cycles = 7;
  EXPECT_EQ(view.profile(TaskId{1u}).execution[CHIMERA_CYCLE].max, microseconds(3));
  EXPECT_EQ(view.profile(TaskId{1u}).cycles, 7u);
  EXPECT_EQ(view.profile(TaskId{0u}).response.min, kNever);  // zeroed bytes are made a profile
  owner.set_goal(TaskId{0u}, 0x81);
  owner.set_tapped(TaskId{2u}, true);
  EXPECT_EQ(view.goal(TaskId{0u}), 0x81u);
  EXPECT_EQ(view.goal(TaskId{2u}), 0u);
  EXPECT_TRUE(view.is_tapped(TaskId{2u}));
  EXPECT_FALSE(view.is_tapped(TaskId{0u}));
  owner.set_tapped(TaskId{2u}, false);
  EXPECT_FALSE(view.is_tapped(TaskId{2u}));
  owner.memory().events = 12;
  EXPECT_EQ(view.memory().events, 12u);
}

TEST(RtpuBlock, RingsOfDifferentPeersAreDifferentAndAllOfThemAreInside) {
  const Bytes bytes = zeroed(block_bytes(1));
  const BlockOwner owner(bytes.get(), 0, 1, 1, kMaxPeers);
  for (std::uint32_t peer = 0; peer < kMaxPeers; ++peer) {
    Inbox inbox(owner.outbox(peer), owner.progress(peer), 1);
    Outbox outbox(owner.outbox(peer), &owner.view().progress(peer), 1);
    for (std::size_t i = 0; i < kPosts; ++i) {
      Post post;
      post.command = peer;
      ASSERT_TRUE(outbox.try_post(post));
    }
    Post post;
    ASSERT_TRUE(inbox.take(post));
    EXPECT_EQ(post.command, peer);
  }
  Tap tap(owner.tap());
  for (std::size_t i = 0; i < kTapRecords; ++i) tap.append({});
  for (std::uint32_t peer = 0; peer < kMaxPeers; ++peer) EXPECT_EQ(owner.outbox(peer).posted, kPosts);
  EXPECT_EQ(owner.view().status(TaskId{0u}), TaskStatus{});
  EXPECT_EQ(owner.head().magic, kBlockMagic);
}

TEST(RtpuBlock, AnInvalidStatusWordReadsAsError) {
  EXPECT_EQ(TaskStatus::of(4).state, State::kError);
  EXPECT_EQ(TaskStatus::of(255).state, State::kError);
  const TaskStatus status{State::kOff, false, 0xffffffff};
  EXPECT_EQ(TaskStatus::of(status.word()), status);
}

TEST(RtpuBlock, RandomBytesNeverLeadOutsideOrIntoALoop) {
  constexpr std::uint32_t kTasks = 5;
  const std::uint64_t size = block_bytes(kTasks);
  const Bytes bytes = zeroed(size);
  std::mt19937_64 random(3);
  std::uint64_t states = 0;
  for (int round = 0; round < 4; ++round) {
    for (std::uint64_t i = 0; i + 8 <= size; i += 8) {
      const std::uint64_t word = random();
      std::memcpy(bytes.get() + i, &word, 8);
    }
    const BlockView view(bytes.get(), kTasks);
    for (std::uint32_t i = 0; i < kTasks; ++i) {
      ASSERT_LT(static_cast<int>(view.status(TaskId{i}).state), kStates);
      states += view.goal(TaskId{i}) + (view.is_tapped(TaskId{i}) ? 1 : 0) + view.profile(TaskId{i}).cycles;
    }
    for (std::uint32_t peer = 0; peer < kMaxPeers; ++peer) {
      PostProgress progress;
      Inbox inbox(view.outbox(peer), progress, 1);
      Post post;
      while (inbox.take(post)) ++states;
      Outbox outbox(const_cast<PostRing&>(view.outbox(peer)), &view.progress(peer), 1);
      states += outbox.try_post({}) ? 1 : 0;
    }
    TapReader reader(view.tap(), true);
    std::vector<TapRecord> out(1000);
    while (reader.read(out) > 0) ++states;
  }
  EXPECT_GT(states, 0u);
}

}  // namespace
}  // namespace chimera
