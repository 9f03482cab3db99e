// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/background.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

namespace chimera {
namespace {

TEST(Background, GivesWayInAChildAndNotInItsParent) {
  constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;
  const int before = ::getpriority(PRIO_PROCESS, 0);
  const pid_t child = ::fork();
  if (child == 0) {
    run_in_background(kMemory);
    int score = 0;
    std::ifstream("/proc/self/oom_score_adj") >> score;
    rlimit core{}, addresses{};
    ::getrlimit(RLIMIT_CORE, &core);
    ::getrlimit(RLIMIT_AS, &addresses);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const bool is_bound = addresses.rlim_cur == kMemory;
#else
    const bool is_bound = true;
#endif
    const bool gives_way = ::getpriority(PRIO_PROCESS, 0) >= 10;
    ::_exit((gives_way ? 0 : 1) | (score == 1000 ? 0 : 2) | (core.rlim_cur == 0 ? 0 : 4) | (is_bound ? 0 : 8));
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), before);
}

}  // namespace
}  // namespace chimera
