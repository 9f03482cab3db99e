// SPDX-License-Identifier: Apache-2.0
// For a release build: under the address sanitizer mlockall does nothing.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "chimera/platform/realtime.h"

namespace chimera {
namespace {

long locked_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmLck:")) return std::stol(line.substr(6));
  return -1;
}

TEST(RealtimeMemory, IsReportedLockedIfTheKernelReportsIt) {
  const RealtimeGrant grant = enter_realtime({.priority = 0, .cpu = -1, .lock_memory = true});
  EXPECT_EQ(grant.memory, locked_kib() > 0);
  if (grant.memory) {
    EXPECT_TRUE(grant.report.view().ends_with("\n  granted: memory locked")) << grant.report.view();
  } else {
    EXPECT_NE(grant.report.view().find("set RLIMIT_MEMLOCK to unlimited"), std::string_view::npos);
  }
  ::munlockall();
}

// The usual limit of an ordinary user lets a small process lock its memory, and then refuses each further mapping.
TEST(RealtimeMemory, IsNotLockedWithoutRoomForLaterMappings) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::ifstream pages("/proc/self/statm");
    std::uint64_t mapped = 0;
    pages >> mapped;
    mapped *= static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    rlimit limit{};
    ::getrlimit(RLIMIT_MEMLOCK, &limit);
    limit.rlim_cur = limit.rlim_max = std::min<rlim_t>(limit.rlim_max, mapped + (32u << 20));
    if (limit.rlim_cur < mapped + (256u << 10) || ::setrlimit(RLIMIT_MEMLOCK, &limit) != 0) ::_exit(77);
    if (::geteuid() == 0 && ::setuid(54321) != 0) ::_exit(77);
    const std::uint64_t room = limit.rlim_cur - mapped + (64u << 10);
    const auto can_map = [](std::uint64_t bytes) {
      return ::mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED;
    };
    if (!enter_realtime({.lock_memory = true}).memory || can_map(room)) ::_exit(1);
    ::munlockall();
    ::_exit(enter_realtime({.lock_memory = true, .room = room}).memory || !can_map(room) ? 2 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "the limit of locked memory is below the size of this test";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace chimera
