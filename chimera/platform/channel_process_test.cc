// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/channel.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <iterator>

#include "chimera/platform/frozen_bytes.h"

namespace chimera {
namespace {

using Letter = std::array<std::byte, 8>;

Letter letter(std::uint64_t number) {
  Letter made;
  std::memcpy(made.data(), &number, sizeof number);
  return made;
}

std::pair<Channel, Channel> make_pair() {
  auto made = Channel::pair();
  EXPECT_TRUE(made.has_value());
  return *std::move(made);
}

TEST(Channel, MessagesArriveWholeAndInOrder) {
  const auto [here, there] = make_pair();
  ASSERT_TRUE(here.send(letter(1)));
  ASSERT_TRUE(here.send(letter(2)));
  Letter got{};
  int passed = 0;
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(got, letter(1));
  EXPECT_EQ(passed, -1);
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(got, letter(2));
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kNothing);
}

TEST(Channel, ADescriptorComesWithItsMessageAndIsNotInheritedFurther) {
  const auto [here, there] = make_pair();
  const auto bytes = FrozenBytes::create("test", letter(7));
  ASSERT_TRUE(here.send(letter(1), bytes->descriptor()));
  Letter got{};
  int passed = -1;
  ASSERT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  ASSERT_GE(passed, 0);
  EXPECT_NE(passed, bytes->descriptor());
  EXPECT_EQ(::fcntl(passed, F_GETFD), FD_CLOEXEC);
  EXPECT_EQ(FrozenBytes::open(passed)->bytes().size(), 8u);
  ::close(passed);
}

TEST(Channel, TheLastMessageOfAnEndThatDiedWithOneUnreadArrives) {
  auto [here, there] = make_pair();
  const auto bytes = FrozenBytes::create("test", letter(7));
  ASSERT_TRUE(here.send(letter(1), bytes->descriptor()));
  ASSERT_TRUE(there.send(letter(2)));  // which nobody reads
  { const Channel ends_here = std::move(here); }
  Letter got{};
  int passed = -1;
  ASSERT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(got, letter(1));
  EXPECT_EQ(FrozenBytes::open(passed)->bytes().size(), 8u);
  ::close(passed);
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kClosed);
}

TEST(Channel, ADeadEndIsClosedAfterItsLastMessage) {
  auto [here, there] = make_pair();
  ASSERT_TRUE(here.send(letter(1)));
  { const Channel ends_here = std::move(here); }
  Letter got{};
  int passed = -1;
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kClosed);
  EXPECT_FALSE(there.send(letter(2))) << "and no SIGPIPE";
}

TEST(Channel, AMessageOfAnotherLengthIsAStranger) {
  const auto [here, there] = make_pair();
  Letter got{};
  int passed = -1;
  const std::array<std::byte, 4> brief{};
  ASSERT_TRUE(here.send(brief));
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kClosed);
  const auto bytes = FrozenBytes::create("test", letter(7));
  const std::array<std::byte, 16> lengthy{};
  ASSERT_TRUE(here.send(lengthy, bytes->descriptor()));
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kClosed);
  EXPECT_EQ(passed, -1) << "what came with it is closed";
}

TEST(Channel, SurplusDescriptorsAreClosed) {
  const auto [here, there] = make_pair();
  const int two[2] = {::dup(2), ::dup(2)};
  union {
    cmsghdr head;
    char bytes[CMSG_SPACE(sizeof two)];
  } control{};
  Letter sent = letter(1);
  iovec part{sent.data(), sent.size()};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = &control;
  message.msg_controllen = sizeof control;
  control.head.cmsg_level = SOL_SOCKET;
  control.head.cmsg_type = SCM_RIGHTS;
  control.head.cmsg_len = CMSG_LEN(sizeof two);
  std::memcpy(CMSG_DATA(&control.head), two, sizeof two);
  ASSERT_EQ(::sendmsg(here.descriptor(), &message, 0), 8);
  const auto n_open = [] { return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}); };
  const auto before = n_open();
  Letter got{};
  int passed = -1;
  ASSERT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_GE(passed, 0);
  EXPECT_EQ(n_open(), before + 1);
  for (const int fd : {two[0], two[1], passed}) ::close(fd);
}

TEST(Channel, AFullOneRefusesAndNeverBlocks) {
  const auto [here, there] = make_pair();
  int sent = 0;
  while (sent < 1'000'000 && here.send(letter(1))) ++sent;
  EXPECT_GT(sent, 10);
  EXPECT_LT(sent, 1'000'000);
  Letter got{};
  int passed = -1;
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
}

}  // namespace
}  // namespace chimera
