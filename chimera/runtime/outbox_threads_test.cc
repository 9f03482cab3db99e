// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <thread>

#include "chimera/runtime/outbox.h"

namespace chimera {
namespace {

Post numbered(std::uint64_t number) {
  Post post;
  post.command = number;
  post.at = Nanoseconds{static_cast<std::int64_t>(number)};
  post.task = TaskId{static_cast<std::uint32_t>(number)};
  post.more = number % 2 == 1;
  post.detail = ~number;
  post.reserved = number * 3;
  return post;
}

bool is_whole(const Post& post) {
  const std::uint64_t n = post.command;
  return post.at.count == static_cast<std::int64_t>(n) && post.task.index == static_cast<std::uint32_t>(n) &&
         post.more == (n % 2 == 1) && post.detail == ~n && post.reserved == n * 3;
}

struct Outboxes : ::testing::Test {
  std::unique_ptr<PostRing> ring = std::make_unique<PostRing>();
  PostProgress progress;
  Post post;

  // Posts until refused; how many went in.
  std::uint64_t fill(Outbox& outbox, std::uint64_t first = 0) {
    std::uint64_t n = 0;
    while (outbox.try_post(numbered(first + n))) ++n;
    return n;
  }
};

TEST_F(Outboxes, PostsArriveInOrderAndOnce) {
  Inbox inbox(*ring, progress, 1);
  Outbox outbox(*ring, &progress, 1);
  for (std::uint64_t i = 0; i < 3; ++i) ASSERT_TRUE(outbox.try_post(numbered(i)));
  for (std::uint64_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(inbox.take(post));
    EXPECT_EQ(post.command, i);
    EXPECT_TRUE(is_whole(post));
  }
  EXPECT_FALSE(inbox.take(post));
}

TEST_F(Outboxes, AFullRingRefusesAndLosesNothing) {
  Inbox inbox(*ring, progress, 1);
  Outbox outbox(*ring, &progress, 1);
  EXPECT_EQ(fill(outbox), kPosts);
  ASSERT_TRUE(inbox.take(post));
  EXPECT_TRUE(outbox.try_post(numbered(kPosts)));
  EXPECT_FALSE(outbox.try_post(numbered(kPosts + 1)));
  for (std::uint64_t i = 1; i <= kPosts; ++i) {
    ASSERT_TRUE(inbox.take(post));
    ASSERT_EQ(post.command, i);
  }
  EXPECT_FALSE(inbox.take(post));
}

TEST_F(Outboxes, SaysHowMuchRoomThereIsAndWhetherItsReaderFollows) {
  Outbox outbox(*ring, &progress, 3);
  EXPECT_FALSE(outbox.is_followed());
  ASSERT_TRUE(outbox.try_post(numbered(0)));
  EXPECT_EQ(outbox.room(), kPosts - 1);
  Inbox inbox(*ring, progress, 3);
  EXPECT_TRUE(outbox.is_followed());
  EXPECT_EQ(outbox.room(), kPosts);
  fill(outbox);
  EXPECT_EQ(outbox.room(), 0u);
  outbox.set_reader(nullptr);
  EXPECT_FALSE(outbox.is_followed());
  EXPECT_FALSE(Outbox(*ring, &progress, 4).is_followed());
}

TEST_F(Outboxes, ASuccessorGoesOnWhereTheReaderStopped) {
  Inbox first(*ring, progress, 3);
  Outbox outbox(*ring, &progress, 3);
  for (std::uint64_t i = 0; i < 3; ++i) ASSERT_TRUE(outbox.try_post(numbered(i)));
  ASSERT_TRUE(first.take(post));
  PostProgress copied;
  copied.word = progress.word.load();
  Inbox second = Inbox::resume(*ring, copied, 3);
  for (std::uint64_t i = 1; i < 3; ++i) {
    ASSERT_TRUE(second.take(post));
    EXPECT_EQ(post.command, i);
  }
  EXPECT_FALSE(second.take(post));
  PostProgress older;
  older.word = progress.word.load();
  EXPECT_FALSE(Inbox::resume(*ring, older, 4).take(post));
  PostProgress wrong;
  wrong.word = (progress.word.load() & ~((std::uint64_t{1} << 40) - 1)) + 1000;
  EXPECT_FALSE(Inbox::resume(*ring, wrong, 3).take(post));
}

TEST_F(Outboxes, ANewReaderBeginsBehindEarlierPosts) {
  Outbox outbox(*ring, &progress, 7);
  ASSERT_TRUE(outbox.try_post(numbered(0)));
  Inbox first(*ring, progress, 7);
  EXPECT_FALSE(first.take(post));
  ASSERT_TRUE(outbox.try_post(numbered(1)));
  PostProgress fresh;
  outbox.set_reader(&fresh);
  Inbox second(*ring, fresh, 7);
  EXPECT_FALSE(second.take(post));
  ASSERT_TRUE(outbox.try_post(numbered(2)));
  ASSERT_TRUE(second.take(post));
  EXPECT_EQ(post.command, 2u);
}

TEST_F(Outboxes, WithoutAReaderTheRingFillsOnce) {
  Outbox outbox(*ring, nullptr, 1);
  EXPECT_EQ(fill(outbox), kPosts);
  outbox.set_reader(&progress);  // mapped, not attached
  EXPECT_FALSE(outbox.try_post(numbered(0)));
  Inbox inbox(*ring, progress, 1);
  EXPECT_EQ(fill(outbox), kPosts);
}

TEST_F(Outboxes, ANewSenderDoesNotBelieveTheProgressInTheRingOfItsPredecessor) {
  Inbox old_inbox(*ring, progress, 1);
  Outbox old_outbox(*ring, &progress, 1);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(old_outbox.try_post(numbered(0)) && old_inbox.take(post));
  auto fresh = std::make_unique<PostRing>();
  Outbox outbox(*fresh, &progress, 2);
  EXPECT_EQ(fill(outbox), kPosts);  // 200 counted in would let 56 be overwritten unread
  Inbox inbox(*fresh, progress, 2);
  EXPECT_EQ(fill(outbox, 1000), kPosts);
  ASSERT_TRUE(inbox.take(post));
  EXPECT_EQ(post.command, 1000u);
}

TEST_F(Outboxes, TheCountOfProgressMayWrap) {
  ring->posted = (std::uint64_t{1} << 40) - 3;
  Inbox inbox(*ring, progress, 9);
  Outbox outbox(*ring, &progress, 9);
  for (std::uint64_t i = 0; i < 10; ++i) {
    ASSERT_TRUE(outbox.try_post(numbered(i)));
    ASSERT_TRUE(inbox.take(post));
    ASSERT_EQ(post.command, i);
  }
  EXPECT_EQ(fill(outbox), kPosts);
}

TEST_F(Outboxes, AReaderThatClaimsToBeAheadGetsNothingMore) {
  Outbox outbox(*ring, &progress, 1);
  progress.word = std::uint64_t{1} << 40 | 5;
  EXPECT_FALSE(outbox.try_post(numbered(0)));
}

TEST_F(Outboxes, SkipsPostsThatNoSenderWrites) {
  Inbox inbox(*ring, progress, 1);
  Outbox outbox(*ring, &progress, 1);
  for (std::uint64_t i = 0; i < 6; ++i) ASSERT_TRUE(outbox.try_post(numbered(i)));
  auto* bytes = reinterpret_cast<unsigned char*>(ring->posts);
  bytes[offsetof(Post, more)] = 2;
  bytes[sizeof(Post) + offsetof(Post, kind)] = 9;
  bytes[2 * sizeof(Post) + offsetof(Post, signal)] = CHIMERA_SIGNALS;
  bytes[3 * sizeof(Post) + offsetof(Post, after)] = kStates;
  bytes[4 * sizeof(Post) + offsetof(Post, why)] = 77;
  ASSERT_TRUE(inbox.take(post));
  EXPECT_EQ(post.command, 5u);
  EXPECT_EQ(fill(outbox), kPosts);  // a skipped post counts as taken
}

TEST_F(Outboxes, EveryHappeningArrives) {
  Inbox inbox(*ring, progress, 1);
  Outbox outbox(*ring, &progress, 1);
  constexpr int kHappenings = static_cast<int>(kLastHappening) + 1;
  for (int i = 0; i < kHappenings; ++i) {
    Post told = numbered(0);
    told.kind = PostKind::kEvent;
    told.happening = static_cast<EventKind>(i);
    ASSERT_TRUE(outbox.try_post(told));
    ASSERT_TRUE(inbox.take(post)) << i;
    EXPECT_EQ(post.happening, told.happening);
  }
  Post unknown = numbered(0);
  unknown.happening = static_cast<EventKind>(kHappenings);
  ASSERT_TRUE(outbox.try_post(unknown));
  EXPECT_FALSE(inbox.take(post));
}

TEST_F(Outboxes, RandomBytesNeverLeadOutOfTheRingOrIntoALoop) {
  std::mt19937_64 random(1);
  auto* words = reinterpret_cast<std::uint64_t*>(ring.get());
  std::uint64_t taken = 0;
  for (int round = 0; round < 300; ++round) {
    const std::uint64_t mask = round % 3 == 0 ? 0x0101010101010101u : ~std::uint64_t{0};
    for (std::size_t i = 0; i < sizeof(PostRing) / 8; ++i) words[i] = random() & mask;
    if (round % 2 == 1) ring->posted = random() % 600;
    progress.word = random();
    Outbox outbox(*ring, &progress, static_cast<std::uint32_t>(random()));
    Inbox inbox(*ring, progress, static_cast<std::uint32_t>(random()));
    for (int i = 0; i < 20; ++i) {
      if (i % 3 == 0) ring->posted = ring->posted + random() % 300;
      if (i % 7 == 0) ring->posted = random();
      if (i % 4 == 0) progress.word = random();
      if (outbox.try_post(numbered(random()))) ++taken;
      while (inbox.take(post)) ++taken;
    }
  }
  EXPECT_GT(taken, 0u);
}

TEST_F(Outboxes, AMillionPostsBetweenTwoThreadsAreWholeAndNoneIsLost) {
  constexpr std::uint64_t kMillion = 1'000'000;
  Inbox inbox(*ring, progress, 1);
  std::thread writer([this] {
    Outbox outbox(*ring, &progress, 1);
    for (std::uint64_t i = 0; i < kMillion;) {
      if (outbox.try_post(numbered(i))) ++i;
      else std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < kMillion;) {
    if (!inbox.take(post)) {
      std::this_thread::yield();
      continue;
    }
    if (post.command != i || !is_whole(post)) ++wrong;
    ++i;
  }
  writer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_FALSE(inbox.take(post));
}

}  // namespace
}  // namespace chimera
