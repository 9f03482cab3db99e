// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/descriptor.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace chimera::descriptor_test {
namespace {

void say(const Pipe& pipe, const std::string& text) {
  ASSERT_EQ(::write(pipe.writing.fd, text.data(), text.size()), std::ssize(text));
}

TEST(Pipe, GivesTheFirstLineWithoutItsEnd) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  say(*pipe, "ready\nmore");
  EXPECT_EQ(pipe->first_line(seconds(60)), "ready");
}

TEST(Pipe, CutsALongLine) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  say(*pipe, std::string(300, 'x') + "\n");
  EXPECT_EQ(pipe->first_line(seconds(60)), std::string(200, 'x'));
}

TEST(Pipe, GivesNothingWhenTheWriterClosesOrIsLate) {
  auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  say(*pipe, "half a line");
  EXPECT_EQ(pipe->first_line(milliseconds(40)), "");
  pipe->writing = OwnedDescriptor();
  EXPECT_EQ(pipe->first_line(seconds(100)), "");
}

TEST(Readiness, SeesAReadableDescriptorAndSkipsNegativeNumbers) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  const int descriptors[] = {-1, pipe->reading.fd};
  EXPECT_FALSE(await_readable(descriptors, milliseconds(1)));
  EXPECT_FALSE(await_readable(descriptors, Nanoseconds{-1}));
  say(*pipe, "x");
  EXPECT_TRUE(await_readable(descriptors, kNever));
}

TEST(Readiness, ClosedPipeEndsTheWait) {
  auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  pipe->writing = OwnedDescriptor();
  const int descriptors[] = {pipe->reading.fd};
  EXPECT_TRUE(await_readable(descriptors, seconds(100)));
}

TEST(Readiness, NamesReadyAndLostDescriptors) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  Watched watched[] = {{pipe->reading.fd}, {pipe->writing.fd, true}, {-1}, {1'000'000}};
  EXPECT_EQ(await_ready(watched, seconds(60)), 2);
  EXPECT_FALSE(watched[0].is_ready);
  EXPECT_TRUE(watched[1].is_ready);
  EXPECT_FALSE(watched[1].is_lost);
  EXPECT_FALSE(watched[2].is_ready);
  EXPECT_TRUE(watched[3].is_lost);
  EXPECT_EQ(await_ready(std::span(watched).first(1), milliseconds(1)), 0);
  EXPECT_FALSE(watched[0].is_ready);
}

TEST(DescriptorSet, ReturnsTheReadyMembers) {
  const auto set = DescriptorSet::open(Message("test"));
  ASSERT_TRUE(set);
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  OwnedDescriptor near(ends[0]);
  const OwnedDescriptor far(ends[1]);
  EXPECT_TRUE(set->add(far.fd, kToRead, 7));
  EXPECT_FALSE(set->add(far.fd, kToRead, 7));
  DescriptorSet::Ready ready[4];
  EXPECT_EQ(set->take(ready), 0u);
  EXPECT_EQ(::write(near.fd, "x", 1), 1);
  ASSERT_EQ(set->take(ready), 1u);
  EXPECT_EQ(ready[0].number, 7u);
  EXPECT_TRUE(ready[0].is_readable);
  EXPECT_FALSE(ready[0].has_ended);
  EXPECT_TRUE(set->change(far.fd, kToWrite, 8));
  ASSERT_EQ(set->take(ready), 1u);
  EXPECT_EQ(ready[0].number, 8u);
  EXPECT_FALSE(ready[0].is_readable);
  near = OwnedDescriptor();
  ASSERT_EQ(set->take(ready), 1u);
  EXPECT_TRUE(ready[0].has_ended);
}

}  // namespace
}  // namespace chimera::descriptor_test
