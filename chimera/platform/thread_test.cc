// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/thread.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <thread>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/platform/wake.h"

namespace chimera::thread_test {
namespace {

TEST(ThreadLevel, ThreadIsAsleepWhileItWaitsOnly) {
  std::atomic<std::uint32_t> word{0};
  std::atomic<pid_t> id{0};
  std::thread waits([&] {
    id = this_thread();
    const Doorbell bell(word);
    while (bell.read() == 0) (void)bell.wait_until(0, kNever);
  });
  while (id == 0) std::this_thread::yield();
  EXPECT_TRUE(await_that([&] { return is_asleep(id); }));
  EXPECT_FALSE(is_asleep(this_thread()));
  word = 1;
  Doorbell(word).ring();
  waits.join();
  EXPECT_FALSE(is_asleep(id)) << "the thread is gone";
}

TEST(ThreadLevel, ExecutionTimeOfAGoneThreadIsNever) {
  pid_t id = 0;
  std::thread([&id] { id = this_thread(); }).join();
  EXPECT_TRUE(await_that([&] { return used_by(id) == kNever; })) << "the kernel ends the thread a little after join()";
  EXPECT_NE(used_by(this_thread()), kNever);
}

TEST(ThreadRights, AreThoseOfAnOrdinaryThread) {
  ThreadRights rights;
  ASSERT_TRUE(look_up_rights(::getpid(), rights));
  EXPECT_EQ(rights.thread, ::getpid());
  EXPECT_EQ(rights.policy, ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK);
  EXPECT_FALSE(look_up_rights(0x7fffffff, rights));
}

TEST(ThreadRights, NameTheOneCpuOfABoundThread) {
  std::thread([] {
    const int cpu = ::sched_getcpu();
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(cpu), &set);
    ASSERT_EQ(::sched_setaffinity(0, sizeof set, &set), 0);
    ThreadRights rights;
    ASSERT_TRUE(look_up_rights(0, rights));
    EXPECT_EQ(rights.only_cpu, cpu);
  }).join();
}

std::size_t stack_of_a_new_thread() {
  std::size_t bytes = 0;
  std::thread([&bytes] {
    pthread_attr_t attributes;
    pthread_getattr_np(pthread_self(), &attributes);
    pthread_attr_getstacksize(&attributes, &bytes);
    pthread_attr_destroy(&attributes);
  }).join();
  return bytes;
}

TEST(ThreadStack, HoldsForThreadsThatStartDuringItsLifetime) {
  const std::size_t before = stack_of_a_new_thread();
  {
    const ThreadStack stack(1 << 20);
    EXPECT_EQ(stack_of_a_new_thread(), std::size_t{1} << 20);
    const ThreadStack unchanged(0);
    EXPECT_EQ(stack_of_a_new_thread(), std::size_t{1} << 20);
  }
  EXPECT_EQ(stack_of_a_new_thread(), before);
}

class SwitchWatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!SwitchWatch::can_tell()) GTEST_SKIP() << "this system has no restartable sequences";
  }
};

void stay_on_this_processor() {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
}

Nanoseconds compute(Nanoseconds time) {
  const Nanoseconds start = LinuxClock().now();
  Nanoseconds now = start;
  while (now < start + time) now = LinuxClock().now();
  return now - start;
}

// A thread keeps its processor for some microseconds nearly always; it does not lose it a hundred times in a row.
TEST_F(SwitchWatchTest, SeesNoSwitchWhileTheThreadKeepsItsProcessor) {
  bool kept = false;
  for (int i = 0; i < 100 && !kept; ++i) {
    SwitchWatch::begin();
    (void)compute(microseconds(10));
    kept = SwitchWatch::end();
  }
  EXPECT_TRUE(kept);
}

TEST_F(SwitchWatchTest, SystemCallWithoutASleepIsNoSwitch) {
  bool kept = false;
  for (int i = 0; i < 100 && !kept; ++i) {
    SwitchWatch::begin();
    (void)used_by_this_thread();
    kept = SwitchWatch::end();
  }
  EXPECT_TRUE(kept);
}

TEST_F(SwitchWatchTest, SeesASleep) {
  for (int i = 0; i < 20; ++i) {
    SwitchWatch::begin();
    (void)LinuxClock().wait_until(LinuxClock().now() + microseconds(50));
    EXPECT_FALSE(SwitchWatch::end());
  }
}

// Both threads are on one processor: a thread that sees the count of the other grow has lost the processor.
TEST_F(SwitchWatchTest, SeesThatAnotherThreadHadTheProcessor) {
  stay_on_this_processor();
  std::atomic<std::uint64_t> count{0};
  std::atomic<bool> over{false};
  std::thread other([&] {
    while (!over) ++count;
  });
  for (int i = 0; i < 10; ++i) {
    SwitchWatch::begin();
    for (const std::uint64_t before = count; count == before;) {
    }
    EXPECT_FALSE(SwitchWatch::end());
  }
  over = true;
  other.join();
}

TEST_F(SwitchWatchTest, SeesASignal) {
  struct sigaction ignore_it {};
  struct sigaction before {};
  ignore_it.sa_handler = [](int) {};
  ASSERT_EQ(sigaction(SIGUSR2, &ignore_it, &before), 0);
  SwitchWatch::begin();
  (void)raise(SIGUSR2);
  EXPECT_FALSE(SwitchWatch::end());
  ASSERT_EQ(sigaction(SIGUSR2, &before, nullptr), 0);
}

TEST_F(SwitchWatchTest, EndsOnce) {
  SwitchWatch::begin();
  (void)SwitchWatch::end();
  EXPECT_FALSE(SwitchWatch::end());
}

// The claim that its user needs: without a switch, elapsed time is execution time. A stall of the machine in some of
// the samples does not move the median.
TEST_F(SwitchWatchTest, ElapsedTimeIsExecutionTimeWithoutASwitch) {
  stay_on_this_processor();
  std::vector<std::int64_t> differences;
  for (int i = 0; i < 400; ++i) {
    const Nanoseconds before = used_by_this_thread();
    SwitchWatch::begin();
    const Nanoseconds passed = compute(microseconds(200));
    if (SwitchWatch::end()) differences.push_back((used_by_this_thread() - before - passed).count);
  }
  ASSERT_GT(differences.size(), 10u);
  std::sort(differences.begin(), differences.end());
  EXPECT_NEAR(static_cast<double>(differences[differences.size() / 2]), 0, 20'000);
}

}  // namespace
}  // namespace chimera::thread_test
