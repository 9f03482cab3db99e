// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/process_state.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <ctime>

namespace chimera {
namespace {

char await_letter(pid_t pid, char letter) {
  for (int i = 0; i < 60'000 && process_state(pid).letter != letter; ++i) ::usleep(1'000);
  return process_state(pid).letter;
}

TEST(ProcessState, DistinguishesAWaitingFromAStoppedProcess) {
  const pid_t child = ::fork();
  if (child == 0)
    for (;;) ::pause();
  EXPECT_EQ(await_letter(child, 'S'), 'S');
  ::kill(child, SIGSTOP);  // still ours
  EXPECT_EQ(await_letter(child, 'T'), 'T');
  EXPECT_EQ(process_state(child).tracer, 0);
  ::kill(child, SIGKILL);  // still ours
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(process_state(child).letter, 0) << "the process is gone";
}

TEST(ProcessState, CountsTheProcessorTime) {
  const Nanoseconds before = process_state(::getpid()).used;
  const auto used = [] {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return seconds(now.tv_sec) + Nanoseconds{now.tv_nsec};
  };
  for (const Nanoseconds end = used() + milliseconds(60); used() < end;) {
  }
  EXPECT_GE(process_state(::getpid()).used, before + milliseconds(30));
  EXPECT_EQ(process_state(::getpid()).letter, 'R');
}

}  // namespace
}  // namespace chimera
