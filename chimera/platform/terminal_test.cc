// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/terminal.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "chimera/platform/pipe.h"

namespace chimera {
namespace {

TEST(Terminal, APipeIsNoneAndHasTheSizeThatTheEnvironmentSays) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  EXPECT_FALSE(is_terminal(pipe->reading.fd));
  ::setenv("COLUMNS", "132", 1);
  ::setenv("LINES", "5000", 1);
  EXPECT_EQ(screen_size(pipe->reading.fd).width, 132u);
  EXPECT_EQ(screen_size(pipe->reading.fd).height, 24u);
  ::unsetenv("COLUMNS");
  ::unsetenv("LINES");
  EXPECT_EQ(screen_size(pipe->reading.fd).width, 80u);
}

}  // namespace
}  // namespace chimera
