// SPDX-License-Identifier: Apache-2.0
// Memory locking can be judged in a release build only: the address sanitizer turns mlockall into nothing.
#include <gtest/gtest.h>
#include <sys/mman.h>

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

TEST(RealtimeMemory, IsReportedLockedWhenTheKernelSaysSo) {
  const RealtimeGrant grant = enter_realtime({.priority = 0, .cpu = -1, .lock_memory = true});
  EXPECT_EQ(grant.memory, locked_kib() > 0);
  if (grant.memory) {
    EXPECT_TRUE(grant.report.view().ends_with("\n  granted: memory locked")) << grant.report.view();
  } else {
    EXPECT_NE(grant.report.view().find("set RLIMIT_MEMLOCK to unlimited"), std::string_view::npos);
  }
  ::munlockall();
}

}  // namespace
}  // namespace chimera
