// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/process_state.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace chimera {
namespace {

TEST(ProcessId, IsTheNumberThatTheSystemShows) {
  EXPECT_EQ(std::filesystem::read_symlink("/proc/self").string(), std::to_string(own_process_id()));
  EXPECT_NE(parent_process_id(), own_process_id());
  EXPECT_EQ(own_session(), ::getsid(own_process_id()));
}

TEST(UserName, IsTheNameInTheFileOtherwiseTheNumber) {
  EXPECT_EQ(user_name(0), "root");
  EXPECT_EQ(user_name(4'000'000'000u), "4000000000");
}

TEST(PageBytes, ArePowerOfTwo) {
  EXPECT_GE(page_bytes(), 4096u);
  EXPECT_EQ(page_bytes() & (page_bytes() - 1), 0u);
}

}  // namespace
}  // namespace chimera
