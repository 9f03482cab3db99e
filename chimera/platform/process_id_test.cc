// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/process_id.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace chimera {
namespace {

TEST(ProcessId, IsTheNumberThatTheSystemShows) {
  EXPECT_EQ(std::filesystem::read_symlink("/proc/self").string(), std::to_string(own_process_id()));
  EXPECT_NE(parent_process_id(), own_process_id());
}

TEST(ProcessId, KnowsTheSessionOfAProcessThatLives) {
  EXPECT_EQ(session_of(own_process_id()), own_session());
  EXPECT_EQ(session_of(0x7fffffff), -1);
}

}  // namespace
}  // namespace chimera
