// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/limits.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

namespace chimera {
namespace {

void lower(__rlimit_resource what, rlim_t to) {
  const rlimit limit{to, to};
  ::setrlimit(what, &limit);
}

TEST(Limits, WhatIsTooLowIsNamedWithItsRemedy) {
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
}  // namespace chimera
