// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/ordinary_thread.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>

#include <future>
#include <thread>

namespace chimera {
namespace {

struct Seen {
  int policy = -1, cpus = 0;
  bool takes_signals = true;
};

Seen look() {
  Seen seen{.policy = ::sched_getscheduler(0)};
  cpu_set_t set;
  ::sched_getaffinity(0, sizeof set, &set);
  seen.cpus = CPU_COUNT(&set);
  sigset_t mask;
  ::pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  seen.takes_signals = ::sigismember(&mask, SIGTERM) == 0;
  return seen;
}

TEST(OrdinaryThread, RunsOnAnyCpuAndTakesNoSignalWhateverItsMakerHas) {
  const Seen before = look();
  std::promise<Seen> seen;
  std::thread([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    ASSERT_TRUE(start_ordinary_thread([&seen] { seen.set_value(look()); }));
  }).join();
  const Seen found = seen.get_future().get();
  EXPECT_EQ(found.policy, SCHED_OTHER);
  EXPECT_GE(found.cpus, before.cpus);
  EXPECT_FALSE(found.takes_signals);
}

}  // namespace
}  // namespace chimera
