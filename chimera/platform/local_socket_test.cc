// SPDX-License-Identifier: Apache-2.0
// Connections of this process with itself, alone and in a DescriptorSet.
#include "chimera/platform/local_socket.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "chimera/platform/descriptor_set.h"

namespace chimera {
namespace {

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

TEST_F(LocalSocketTest, CarriesBytesBothWaysAndTellsTheEnd) {
  listen();
  auto near = connect_to_path(path_, seconds(1));
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

TEST_F(LocalSocketTest, KnowsWhetherSomebodyListens) {
  EXPECT_FALSE(is_listened_at(path_));
  EXPECT_LT(connect_to_path(path_, seconds(1)).fd, 0);
  EXPECT_EQ(errno, ECONNREFUSED);
  listen();
  EXPECT_TRUE(is_listened_at(path_));
  const std::string too_long(200, 'x');
  EXPECT_FALSE(is_listened_at(too_long));
  EXPECT_LT(connect_to_path(too_long, seconds(1)).fd, 0);
  EXPECT_EQ(errno, ENAMETOOLONG);
}

TEST_F(LocalSocketTest, KnowsWhoConnected) {
  listen();
  const auto near = connect_to_path(path_, seconds(1)), far = accept_now(listening_.fd);
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

TEST_F(LocalSocketTest, ADescriptorSetTellsWhichAreReady) {
  listen();
  const auto set = DescriptorSet::open(Message("test"));
  ASSERT_TRUE(set);
  auto near = connect_to_path(path_, seconds(1));
  const auto far = accept_now(listening_.fd);
  EXPECT_TRUE(set->add(far.fd, kToRead, 7));
  EXPECT_FALSE(set->add(far.fd, kToRead, 7));
  DescriptorSet::Ready ready[4];
  EXPECT_EQ(set->take(ready), 0u);
  EXPECT_EQ(send_now(near.fd, "x"), 1);
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
}  // namespace chimera
