// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/realtime.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <string>

#include "chimera/base/testing/few_descriptors.h"

namespace chimera::realtime_process_test {
namespace {

// No machine has this CPU, so a run beside this test is not disturbed. Copies of this test use different numbers.
int cpu() { return 100'000 + static_cast<int>(::getpid()); }

TEST(CpuClaim, RefusesASecondHolderAndNamesTheFirst) {
  const auto first = CpuClaim::take(cpu());
  ASSERT_TRUE(first.has_value()) << first.error().message.view();
  const auto second = CpuClaim::take(cpu());
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, ErrorCode::kRefused);
  const std::string message(second.error().message.view());
  EXPECT_EQ(message, "CPU " + std::to_string(cpu()) + " is in use by another real-time subsystem (process " +
                         std::to_string(::getpid()) + " of user " + std::to_string(::getuid()) +
                         "): end that one, place the rtpu on another CPU, or run with --priority 0");
  EXPECT_TRUE(CpuClaim::take(cpu() + 1).has_value());
}

TEST(CpuClaim, NamesACommandThatFindsASilentHolder) {
  const int silent = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);  // bound, and never listening
  ASSERT_GE(silent, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "chimera-cpu-" + std::to_string(cpu());
  name.copy(address.sun_path + 1, name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  ASSERT_EQ(::bind(silent, reinterpret_cast<const sockaddr*>(&address), size), 0);
  const auto refused = CpuClaim::take(cpu());
  ::close(silent);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(std::string(refused.error().message.view()),
            "CPU " + std::to_string(cpu()) + " is in use by a process that does not answer: find it " +
                "with `ss -xap | grep " + name + "` as root, end it, place the rtpu on another CPU, " +
                "or run with --priority 0");
}

TEST(CpuClaim, EndsWithItsHolderAndMoves) {
  {
    auto first = CpuClaim::take(cpu());
    const CpuClaim moved = *std::move(first);
    EXPECT_TRUE(moved.is_held());
    EXPECT_FALSE(CpuClaim::take(cpu()).has_value());
  }
  EXPECT_TRUE(CpuClaim::take(cpu()).has_value());
}

TEST(CpuClaim, IsFreeAfterTheDeathOfItsProcess) {
  const int number = cpu();
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto held = CpuClaim::take(number);
    if (!held.has_value() || ::write(ends[1], "h", 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ends[0], &byte, 1), 1);
  EXPECT_FALSE(CpuClaim::take(number).has_value());
  ::kill(child, SIGKILL);  // still ours
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(CpuClaim::take(number).has_value());
  ::close(ends[0]);
  ::close(ends[1]);
}

void lower(__rlimit_resource what, rlim_t to) {
  const rlimit limit{to, to};
  ::setrlimit(what, &limit);
}

TEST(Limits, RefusesTooFewOpenFilesWithTheRemedy) {
  EXPECT_TRUE(may_open_here(0));
  for (const int room : {0, 7}) {
    const FewDescriptors few(room);
    EXPECT_EQ(may_open_here(8).has_value(), false);
    EXPECT_EQ(may_open_here(1).has_value(), room == 7);
    EXPECT_EQ(may_open_here(7).has_value(), room == 7);
  }
  const FewDescriptors few(7);
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  const auto refused = may_open_here(9);
  ASSERT_FALSE(refused);
  EXPECT_EQ(std::string(refused.error().message.view()),
            "open files are limited to " + std::to_string(limit.rlim_cur) + ", expected at least " +
                std::to_string(limit.rlim_cur + 2) +
                ", or no process could be restarted: ulimit -n 1024, or LimitNOFILE= of the service");
}

TEST(Limits, RefusesALowLimitWithItsRemedy) {
  EXPECT_TRUE(may_run_here());
  EXPECT_TRUE(may_share_memory_here());
  const pid_t child = ::fork();
  if (child == 0) {
    lower(RLIMIT_FSIZE, 64 << 10);
    lower(RLIMIT_STACK, 128 << 10);
    const auto file = may_share_memory_here(), stack = may_run_here();
    const bool good = !file && !stack &&
                      std::string(file.error().message.c_str()).find("limited to 64 KiB") != std::string::npos &&
                      std::string(stack.error().message.c_str()).find("limited to 128 KiB") != std::string::npos;
    ::_exit(good ? 7 : 8);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

}  // namespace
}  // namespace chimera::realtime_process_test
