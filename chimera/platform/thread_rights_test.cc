// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/thread_rights.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <thread>

#include "chimera/platform/process_id.h"

namespace chimera {
namespace {

TEST(ThreadRights, AreThoseOfAnOrdinaryThread) {
  ThreadRights rights;
  ASSERT_TRUE(look_up_rights(own_process_id(), rights));
  EXPECT_EQ(rights.thread, own_process_id());
  EXPECT_EQ(rights.policy, ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK);
  EXPECT_FALSE(look_up_rights(0x7fffffff, rights));
}

TEST(ThreadRights, NameTheOneCpuOfAThreadThatIsBound) {
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

TEST(ThreadRights, PagesAreAPowerOfTwo) {
  EXPECT_GE(page_bytes(), 4096u);
  EXPECT_EQ(page_bytes() & (page_bytes() - 1), 0u);
}

}  // namespace
}  // namespace chimera
