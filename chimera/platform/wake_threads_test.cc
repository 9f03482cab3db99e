// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/wake.h"

#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <thread>
#include <vector>

namespace chimera::wake_threads_test {
namespace {

TEST(Doorbell, ReachesAnInstantInThePastAtOnceUnlessItRang) {
  std::atomic<std::uint32_t> word{0};
  const Doorbell bell(word);
  EXPECT_EQ(bell.wait_until(bell.read(), {0}), WaitEnd::kReached);
  EXPECT_EQ(bell.wait_until(bell.read(), {-1}), WaitEnd::kReached);
  const std::uint32_t seen = bell.read();
  bell.ring();
  EXPECT_EQ(bell.wait_until(seen, kNever), WaitEnd::kWoken);
}

TEST(Doorbell, ReachesTheInstantWithoutARing) {
  std::atomic<std::uint32_t> word{0};
  const Doorbell bell(word);
  LinuxClock clock;
  const Nanoseconds until = clock.now() + milliseconds(2);
  while (bell.wait_until(bell.read(), until) != WaitEnd::kReached) {
  }
  EXPECT_GE(clock.now(), until);
}

class DoorbellOf : public ::testing::TestWithParam<Ringers> {};

TEST_P(DoorbellOf, LosesNoWakeAndPublishesEarlierWrites) {
  constexpr std::uint32_t kTurns = 20'000;
  std::atomic<std::uint32_t> there{0}, back{0};
  std::uint32_t sent = 0, answered = 0;  // plain on purpose: the bells alone order the accesses
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

TEST(WakeEvent, IsReadableFromTheFirstRingUntilReset) {
  const auto event = WakeEvent::open(Message("test"));
  ASSERT_TRUE(event);
  const int descriptors[] = {event->descriptor()};
  EXPECT_FALSE(await_readable(descriptors, {}));
  event->ring();
  ring_event(event->descriptor());
  EXPECT_TRUE(await_readable(descriptors, {}));
  event->reset();
  EXPECT_FALSE(await_readable(descriptors, {}));
  event->reset();  // does not wait
  ring_event(-1);
}

void write_one(int descriptor) {
  const std::uint64_t one = 1;
  EXPECT_EQ(::write(descriptor, &one, sizeof one), 8);
}

TEST(DescriptorBell, SaysWhetherTheDescriptorIsReadable) {
  DescriptorBell bell;
  const OwnedDescriptor event(::eventfd(0, EFD_CLOEXEC));
  EXPECT_FALSE(bell.await(event.fd, {0}));
  bell.ring();
  EXPECT_FALSE(bell.await(event.fd, kNever)) << "a ring before the wait ends the wait";
  write_one(event.fd);
  EXPECT_TRUE(bell.await(event.fd, kNever));
  bell.ring();
  EXPECT_TRUE(bell.await(event.fd, kNever)) << "a ring and a readable descriptor at once";
  EXPECT_TRUE(bell.await(event.fd, {0})) << "the descriptor was not read";
  EXPECT_FALSE(bell.await(-1, {0}));
}

TEST(DescriptorBell, IsWokenByOtherThreads) {
  DescriptorBell bell;
  const OwnedDescriptor event(::eventfd(0, EFD_CLOEXEC));
  std::thread ringer([&] { bell.ring(); });
  EXPECT_FALSE(bell.await(event.fd, kNever));
  ringer.join();
  std::thread writer([&] { write_one(event.fd); });
  EXPECT_TRUE(bell.await(event.fd, kNever));
  writer.join();
}

TEST(Alarm, RingsAtAnInstantThatAnotherThreadMoves) {
  Alarm alarm;
  ASSERT_TRUE(alarm.is_there());
  LinuxClock clock;
  const Nanoseconds instant = clock.now() + milliseconds(2);
  alarm.set(instant);
  alarm.wait();
  EXPECT_GE(clock.now(), instant);
  alarm.set(kNever);
  std::thread other([&] { alarm.set({0}); });
  alarm.wait();
  other.join();
}

TEST(Section, ExcludesAndCountsEntriesThatFoundItTaken) {
  Section section;
  std::uint64_t sum = 0;  // not atomic: the section protects it
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 20'000; ++i) {
        section.enter();
        ++sum;
        section.leave();
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(sum, 80'000u);
  const std::uint64_t before = section.times_taken();
  section.enter();
  section.leave();
  EXPECT_EQ(section.times_taken(), before);
}

}  // namespace
}  // namespace chimera::wake_threads_test
