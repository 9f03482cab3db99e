// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/signal_queue.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

namespace chimera {
namespace {

bool is_blocked(int number) {
  sigset_t mask;
  ::pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  return ::sigismember(&mask, number) == 1;
}

TEST(SignalQueue, ReturnsTheSignalAndItsSender) {
  const int numbers[] = {SIGUSR1, SIGUSR2};
  auto queue = SignalQueue::open(numbers);
  ASSERT_TRUE(queue);
  SignalQueue::Arrived arrived;
  EXPECT_FALSE(queue->take(arrived));
  ::raise(SIGUSR2);
  ASSERT_TRUE(queue->take(arrived));
  EXPECT_EQ(arrived.number, SIGUSR2);
  EXPECT_EQ(arrived.from, ::getpid());
  EXPECT_FALSE(queue->take(arrived));
}

TEST(SignalQueue, BlocksIgnoredSignalsWithoutReturningThem) {
  const int numbers[] = {SIGUSR1}, ignored[] = {SIGURG};  // SIGURG has no effect when it is unblocked
  auto queue = SignalQueue::open(numbers, ignored);
  ASSERT_TRUE(queue);
  EXPECT_TRUE(is_blocked(SIGURG));
  ::raise(SIGURG);
  SignalQueue::Arrived arrived;
  EXPECT_FALSE(queue->take(arrived));
}

TEST(SignalQueue, RestoresTheMaskOnceAtItsEnd) {
  const int numbers[] = {SIGUSR1};
  {
    SignalQueue kept;
    {
      auto queue = SignalQueue::open(numbers);
      ASSERT_TRUE(queue);
      kept = *std::move(queue);
    }
    EXPECT_TRUE(is_blocked(SIGUSR1));
    EXPECT_GE(kept.descriptor(), 0);
  }
  EXPECT_FALSE(is_blocked(SIGUSR1));
}

TEST(SignalQueue, LeavesItsSignalsBlockedAfterStayBlocked) {
  const int numbers[] = {SIGUSR2};
  {
    auto queue = SignalQueue::open(numbers);
    ASSERT_TRUE(queue);
    queue->stay_blocked();
  }
  EXPECT_TRUE(is_blocked(SIGUSR2));
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, SIGUSR2);
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

TEST(SignalQueue, EmptyQueueBlocksAndReturnsNothing) {
  SignalQueue queue;
  SignalQueue::Arrived arrived;
  EXPECT_FALSE(queue.take(arrived));
  EXPECT_EQ(queue.descriptor(), -1);
}

}  // namespace
}  // namespace chimera
