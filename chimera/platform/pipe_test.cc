// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/pipe.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "chimera/platform/readiness.h"

namespace chimera {
namespace {

void say(const Pipe& pipe, const std::string& text) {
  ASSERT_EQ(::write(pipe.writing.fd, text.data(), text.size()), std::ssize(text));
}

TEST(Pipe, GivesTheFirstLineWithoutItsEnd) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  say(*pipe, "ready\nmore");
  EXPECT_EQ(pipe->first_line(seconds(1)), "ready");
}

TEST(Pipe, CutsALongLine) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  say(*pipe, std::string(300, 'x') + "\n");
  EXPECT_EQ(pipe->first_line(seconds(1)), std::string(200, 'x'));
}

TEST(Pipe, GivesNothingWhenTheWriterClosesOrIsLate) {
  auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  say(*pipe, "half a line");
  EXPECT_EQ(pipe->first_line(milliseconds(40)), "");
  pipe->writing = OwnedDescriptor();
  EXPECT_EQ(pipe->first_line(seconds(100)), "");
}

TEST(Readiness, SeesWhatIsReadableAndLeavesNegativeNumbersOut) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  const int descriptors[] = {-1, pipe->reading.fd};
  EXPECT_FALSE(await_readable(descriptors, milliseconds(1)));
  EXPECT_FALSE(await_readable(descriptors, Nanoseconds{-1}));
  say(*pipe, "x");
  EXPECT_TRUE(await_readable(descriptors, kNever));
}

TEST(Readiness, AClosedPipeEndsTheWait) {
  auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  pipe->writing = OwnedDescriptor();
  const int descriptors[] = {pipe->reading.fd};
  EXPECT_TRUE(await_readable(descriptors, seconds(100)));
}

TEST(Readiness, SaysWhichAreReadyAndWhichAreLost) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  Watched watched[] = {{pipe->reading.fd}, {pipe->writing.fd, true}, {-1}, {1'000'000}};
  EXPECT_EQ(await_ready(watched, seconds(1)), 2);
  EXPECT_FALSE(watched[0].is_ready);
  EXPECT_TRUE(watched[1].is_ready);
  EXPECT_FALSE(watched[1].is_lost);
  EXPECT_FALSE(watched[2].is_ready);
  EXPECT_TRUE(watched[3].is_lost);
  EXPECT_EQ(await_ready(std::span(watched).first(1), milliseconds(1)), 0);
  EXPECT_FALSE(watched[0].is_ready);
}

}  // namespace
}  // namespace chimera
