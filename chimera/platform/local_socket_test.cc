// SPDX-License-Identifier: Apache-2.0
// Connections of this process with itself.
#include "chimera/platform/local_socket.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>

#include "chimera/base/testing/few_descriptors.h"
#include "chimera/platform/shared_memory.h"

namespace chimera::local_socket_test {
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

TEST(Channel, DeliversMessagesWholeAndInOrder) {
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

TEST(Channel, PassesADescriptorThatExecCloses) {
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

TEST(Channel, SaysThatADescriptorFoundNoRoom) {
  const auto [here, there] = make_pair();
  ASSERT_TRUE(here.send(letter(1), here.descriptor()));
  ASSERT_TRUE(here.send(letter(2)));
  const FewDescriptors none(0);
  Letter got{};
  int passed = -1;
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(passed, kLostDescriptor);
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(passed, -1) << "a message without a descriptor lost none";
}

TEST(Channel, DeliversTheLastMessageOfAnEndThatDiedWithAnUnreadMessage) {
  auto [here, there] = make_pair();
  const auto bytes = FrozenBytes::create("test", letter(7));
  ASSERT_TRUE(here.send(letter(1), bytes->descriptor()));
  ASSERT_TRUE(there.send(letter(2)));  // stays unread
  { const Channel ends_here = std::move(here); }
  Letter got{};
  int passed = -1;
  ASSERT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(got, letter(1));
  EXPECT_EQ(FrozenBytes::open(passed)->bytes().size(), 8u);
  ::close(passed);
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kClosed);
}

TEST(Channel, IsClosedAfterTheLastMessageOfADeadEnd) {
  auto [here, there] = make_pair();
  ASSERT_TRUE(here.send(letter(1)));
  { const Channel ends_here = std::move(here); }
  Letter got{};
  int passed = -1;
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kClosed);
  EXPECT_FALSE(there.send(letter(2))) << "and no SIGPIPE";
}

TEST(Channel, ClosesOnAMessageOfAnotherLength) {
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
  EXPECT_EQ(passed, -1) << "the passed descriptor is closed";
}

TEST(Channel, ClosesSurplusDescriptors) {
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

TEST(Channel, RefusesWhenFullAndNeverBlocks) {
  const auto [here, there] = make_pair();
  int sent = 0;
  while (sent < 1'000'000 && here.send(letter(1))) ++sent;
  EXPECT_GT(sent, 10);
  EXPECT_LT(sent, 1'000'000);
  Letter got{};
  int passed = -1;
  EXPECT_EQ(there.receive(got, passed), Channel::Got::kMessage);
}

class LocalSocketTest : public ::testing::Test {
 protected:
  LocalSocketTest() : path_(testing::TempDir() + "local_" + std::to_string(::getpid())) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path_.c_str());
    EXPECT_EQ(::bind(listening_.fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~LocalSocketTest() override { ::unlink(path_.c_str()); }
  void listen() { EXPECT_EQ(::listen(listening_.fd, 4), 0); }

  std::string path_;
  OwnedDescriptor listening_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
};

TEST_F(LocalSocketTest, CarriesBytesAndReportsTheEnd) {
  listen();
  auto near = connect_to_path(path_, seconds(60));
  ASSERT_GE(near.fd, 0);
  const auto far = accept_now(listening_.fd);
  ASSERT_GE(far.fd, 0);
  char text[8] = {};
  EXPECT_EQ(receive_now(far.fd, text), -1);
  EXPECT_EQ(errno, EAGAIN);
  EXPECT_EQ(send_now(near.fd, "abc"), 3);
  EXPECT_GT(unread_by_other_end(near.fd), 0);
  EXPECT_EQ(receive_now(far.fd, text), 3);
  EXPECT_STREQ(text, "abc");
  EXPECT_EQ(unread_by_other_end(near.fd), 0);
  near = OwnedDescriptor();
  EXPECT_EQ(receive_now(far.fd, text), 0);
  EXPECT_EQ(send_now(far.fd, "x"), -1);
  EXPECT_EQ(errno, EPIPE);
  EXPECT_EQ(unread_by_other_end(-1), -1);
}

TEST_F(LocalSocketTest, KnowsWhetherAProcessListens) {
  EXPECT_FALSE(is_listened_at(path_));
  EXPECT_LT(connect_to_path(path_, seconds(60)).fd, 0);
  EXPECT_EQ(errno, ECONNREFUSED);
  listen();
  EXPECT_TRUE(is_listened_at(path_));
  const std::string too_long(200, 'x');
  EXPECT_FALSE(is_listened_at(too_long));
  EXPECT_LT(connect_to_path(too_long, seconds(60)).fd, 0);
  EXPECT_EQ(errno, ENAMETOOLONG);
}

TEST_F(LocalSocketTest, KnowsTheProcessThatConnected) {
  listen();
  const auto near = connect_to_path(path_, seconds(60)), far = accept_now(listening_.fd);
  const auto peer = peer_of(far.fd);
  ASSERT_TRUE(peer);
  EXPECT_EQ(peer->process, ::getpid());
  EXPECT_EQ(peer->user, ::geteuid());
  EXPECT_EQ(peer->groups.back(), ::getegid());
  EXPECT_FALSE(peer_of(-1));
}

TEST_F(LocalSocketTest, KnowsOneFileByTwoPaths) {
  const std::size_t slash = path_.rfind('/');
  EXPECT_TRUE(are_one_file(path_, path_.substr(0, slash) + "/." + path_.substr(slash)));
  EXPECT_FALSE(are_one_file(path_, "/"));
  EXPECT_FALSE(are_one_file(path_, path_ + "x"));
}

}  // namespace
}  // namespace chimera::local_socket_test
