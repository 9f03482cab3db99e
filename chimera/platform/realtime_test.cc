// SPDX-License-Identifier: Apache-2.0
// Runs with and without rights: in both cases the report must match the kernel.
#include "chimera/platform/realtime.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string_view>
#include <thread>

#include "chimera/platform/thread.h"

namespace chimera {
namespace {

// Uses a thread of its own, so that the thread of the test stays ordinary.
RealtimeGrant enter_on_a_thread(const RealtimeRequest& request, int* policy = nullptr, int* cpus = nullptr) {
  RealtimeGrant grant;
  std::thread([&] {
    grant = enter_realtime(request);
    const int found = ::sched_getscheduler(0);
    EXPECT_EQ((found & SCHED_RESET_ON_FORK) != 0, request.priority > 0 && grant.priority);
    if (policy != nullptr) *policy = found & ~SCHED_RESET_ON_FORK;
    cpu_set_t set;
    CPU_ZERO(&set);
    ::pthread_getaffinity_np(::pthread_self(), sizeof set, &set);
    if (cpus != nullptr) *cpus = CPU_COUNT(&set);
  }).join();
  return grant;
}

int first_allowed_cpu() {
  cpu_set_t set;
  CPU_ZERO(&set);
  ::sched_getaffinity(0, sizeof set, &set);
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &set)) return cpu;
  return -1;
}

constexpr const char* kOrdinary =
    "WARNING: not real time\n  ordinary scheduling was asked for (priority 0): any job may come late";

TEST(Realtime, EmptyRequestIsGrantedAndNotRealTime) {
  const RealtimeGrant grant = enter_on_a_thread({.priority = 0, .cpu = -1, .lock_memory = false});
  EXPECT_TRUE(grant.is_complete());
  EXPECT_EQ(grant.report.view(), kOrdinary);
}

TEST(Realtime, CpuIsGrantedToAnOrdinaryUser) {
  const int cpu = first_allowed_cpu();
  int cpus = 0;
  const RealtimeGrant grant = enter_on_a_thread({.priority = 0, .cpu = cpu, .lock_memory = false}, nullptr, &cpus);
  EXPECT_TRUE(grant.cpu);
  EXPECT_EQ(cpus, 1);
  EXPECT_EQ(grant.report.view(), std::string(kOrdinary) + "\n  granted: pinned to CPU " + std::to_string(cpu));
}

TEST(Realtime, RefusesAMissingCpuByNumber) {
  const RealtimeGrant grant = enter_on_a_thread({.priority = 0, .cpu = 1000, .lock_memory = false});
  EXPECT_FALSE(grant.cpu);
  EXPECT_EQ(grant.report.view(), "WARNING: not real time\n  CPU 1000 refused: this machine has CPU 0 to " +
                                     std::to_string(::sysconf(_SC_NPROCESSORS_ONLN) - 1) + ", runs unpinned" +
                                     std::string(kOrdinary).substr(std::string(kOrdinary).find('\n')));
}

TEST(Realtime, WhatIsMissingIsReadFromTheReportInOneLine) {
  const auto why = [](std::string_view report) { return std::string(not_real_time(report).view()); };
  EXPECT_EQ(why(kOrdinary), "ordinary scheduling was asked for (priority 0): any job may come late");
  EXPECT_EQ(why("WARNING: not real time\n  memory not locked\n  CPU 7 refused\n  granted: SCHED_FIFO 80"),
            "memory not locked; CPU 7 refused");
  EXPECT_EQ(why("Real-time OK: SCHED_FIFO 80. But " + std::string(kUnboundWords) + "."), kUnboundWords);
  EXPECT_EQ(why("Real-time OK: SCHED_FIFO 80."), "");
  EXPECT_EQ(why(""), "");
}

TEST(Realtime, PriorityIsReportedAsTheKernelHasIt) {
  int policy = -1;
  const RealtimeGrant grant = enter_on_a_thread({.priority = 7, .cpu = -1, .lock_memory = false}, &policy);
  EXPECT_EQ(grant.priority, policy == SCHED_FIFO);
  const std::string_view report = grant.report.view();
  if (grant.priority) {
    EXPECT_TRUE(report.starts_with("Real-time OK: SCHED_FIFO 7.")) << report;
    const bool is_limited = grant.throttle_share < 1;
    EXPECT_EQ(report.find("Kernel limit for RT threads: ") != std::string_view::npos, is_limited) << report;
    EXPECT_GT(grant.throttle_share, 0);
    EXPECT_LE(grant.throttle_share, 1);
  } else {
    EXPECT_TRUE(report.starts_with("WARNING: not real time\n  SCHED_FIFO 7 refused (")) << report;
    EXPECT_NE(report.find("set RLIMIT_RTPRIO to 7 (is "), std::string_view::npos) << report;
  }
}

// A change of the level must keep this: the preemptive executor changes the level for every job.
TEST(Realtime, ThreadsAndProcessesOfARealtimeThreadAreOrdinary) {
  int policies[4] = {-1, -1, -1, -1};
  bool granted = false;
  std::thread([&] {
    const auto policy_of_child = [] {
      const pid_t child = ::fork();
      if (child == 0) ::_exit(::sched_getscheduler(0));
      int status = -1;
      ::waitpid(child, &status, 0);
      return WEXITSTATUS(status);
    };
    granted = enter_realtime({.priority = 7, .cpu = -1, .lock_memory = false}).priority;
    policies[0] = policy_of_child();
    EXPECT_EQ(set_level(0, 5), granted);
    policies[1] = policy_of_child();
    std::thread([&] { policies[2] = ::sched_getscheduler(0); }).join();
    EXPECT_TRUE(set_below_all(this_thread()));
    EXPECT_EQ(set_level(this_thread(), 6), granted);
    policies[3] = policy_of_child();
  }).join();
  for (const int policy : policies) EXPECT_EQ(policy, SCHED_OTHER);
}

TEST(Realtime, RefusesAPriorityOutOfRangeEvenWithRights) {
  int policy = -1;
  const RealtimeGrant grant = enter_on_a_thread({.priority = 100, .cpu = -1, .lock_memory = false}, &policy);
  EXPECT_FALSE(grant.priority);
  EXPECT_EQ(policy, SCHED_OTHER);
}

}  // namespace
}  // namespace chimera
