// SPDX-License-Identifier: Apache-2.0
// For a release build: under the address sanitizer mlockall does nothing.
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

}  // namespace
}  // namespace chimera
