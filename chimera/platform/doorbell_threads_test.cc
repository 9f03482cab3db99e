// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/doorbell.h"

#include <gtest/gtest.h>

#include <thread>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

TEST(Doorbell, AWaitInThePastIsReachedAtOnceUnlessItRang) {
  std::atomic<std::uint32_t> word{0};
  const Doorbell bell(word);
  EXPECT_EQ(bell.wait_until(bell.read(), {0}), WaitEnd::kReached);
  EXPECT_EQ(bell.wait_until(bell.read(), {-1}), WaitEnd::kReached);
  const std::uint32_t seen = bell.read();
  bell.ring();
  EXPECT_EQ(bell.wait_until(seen, kNever), WaitEnd::kWoken);
}

TEST(Doorbell, ReachesTheInstantWhenNobodyRings) {
  std::atomic<std::uint32_t> word{0};
  const Doorbell bell(word);
  LinuxClock clock;
  const Nanoseconds until = clock.now() + milliseconds(2);
  while (bell.wait_until(bell.read(), until) != WaitEnd::kReached) {}
  EXPECT_GE(clock.now(), until);
}

class DoorbellOf : public ::testing::TestWithParam<Ringers> {};

TEST_P(DoorbellOf, NoWakeIsLostAndWhatWasWrittenBeforeIsSeen) {
  constexpr std::uint32_t kTurns = 20'000;
  std::atomic<std::uint32_t> there{0}, back{0};
  std::uint32_t sent = 0, answered = 0;  // plain on purpose: the bells alone order them
  std::thread answerer([&] {
    const Doorbell mine(there, GetParam()), other(back, GetParam());
    for (std::uint32_t turn = 0; turn < kTurns; ++turn) {
      while (mine.read() == turn) mine.wait_until(turn, kNever);
      answered = sent;
      other.ring();
    }
  });
  const Doorbell mine(back, GetParam()), other(there, GetParam());
  std::uint32_t wrong = 0;
  for (std::uint32_t turn = 0; turn < kTurns; ++turn) {
    sent = turn;
    other.ring();
    while (mine.read() == turn) mine.wait_until(turn, kNever);
    wrong += answered != turn ? 1u : 0u;
  }
  answerer.join();
  EXPECT_EQ(wrong, 0u);
}

INSTANTIATE_TEST_SUITE_P(Ringers, DoorbellOf, ::testing::Values(Ringers::kAnyProcess, Ringers::kThisProcess));

}  // namespace
}  // namespace chimera
