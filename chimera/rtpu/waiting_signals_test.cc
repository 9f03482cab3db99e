// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/waiting_signals.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace chimera {
namespace {

struct WaitingSignalsTest : ::testing::Test {
  /// Adds a signal for the task with that letter; `more`: another one of the same transaction follows.
  void add(char task, int command, bool more = false) {
    Post post;
    post.task = TaskId(static_cast<std::uint32_t>(task - 'a'));
    post.command = static_cast<std::uint64_t>(command);
    post.more = more;
    waiting.add(post);
  }
  /// The steps that act() removes while the tasks in `busy` may not be touched.
  std::string acted(const std::string& busy = "") {
    std::string text;
    waiting.act([&](TaskId task) { return busy.find(static_cast<char>('a' + task.index)) == std::string::npos; },
                [&](std::span<const Post> step) {
                  for (const Post& post : step)
                    text += static_cast<char>('a' + post.task.index) + std::to_string(post.command);
                  text += ' ';
                });
    return text;
  }
  WaitingSignals waiting{3};
};

TEST_F(WaitingSignalsTest, AreTakenInTheOrderInWhichTheyCame) {
  add('a', 1);
  add('b', 2);
  add('a', 3);
  EXPECT_EQ(acted(), "a1 b2 a3 ");
  EXPECT_EQ(acted(), "");
}

TEST_F(WaitingSignalsTest, SignalsOfATaskKeepTheirOrderWhileTheyWait) {
  add('a', 1);
  add('b', 2);
  add('a', 3);
  EXPECT_EQ(acted("a"), "b2 ");
  add('b', 4);
  EXPECT_EQ(acted(), "a1 a3 b4 ");
}

TEST_F(WaitingSignalsTest, ATransactionGoesTogetherOrNotAtAll) {
  add('a', 1, true);
  add('b', 1);
  add('a', 2);
  add('c', 3);
  EXPECT_EQ(acted("b"), "c3 ") << "a2 waits behind the transaction";
  EXPECT_EQ(acted(), "a1b1 a2 ");
}

TEST_F(WaitingSignalsTest, AnIncompleteTransactionWaits) {
  add('a', 1, true);
  EXPECT_EQ(acted(), "");
  add('b', 1);
  EXPECT_EQ(acted(), "a1b1 ");
}

TEST_F(WaitingSignalsTest, AFullMemoryIsActedOnThoughItsTransactionIsLonger) {
  while (!waiting.is_full()) add('a', 1, true);
  EXPECT_EQ(acted().size(), 2 * WaitingSignals::kMost + 1);
  EXPECT_FALSE(waiting.is_full());
}

}  // namespace
}  // namespace chimera
