// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/connection.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <optional>

namespace chimera::control {
namespace {

/// "0123...": `count` pieces of `bytes` each, counted as they are made.
class Counted final : public Pieces {
 public:
  Counted(int count, std::size_t bytes, int& made) : left_(count), bytes_(bytes), made_(made) {}
  bool append_to(std::string& text) override {
    text.append(bytes_, static_cast<char>('0' + made_++ % 10));
    return --left_ > 0;
  }

 private:
  int left_;
  std::size_t bytes_;
  int& made_;
};

class ConnectionTest : public ::testing::Test {
 protected:
  ConnectionTest() {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    peer_ = OwnedDescriptor(ends[0]);
    connection_.emplace(1, OwnedDescriptor(ends[1]), PeerIdentity{}, now_);
  }
  std::string take() {
    std::string got;
    char bytes[4096];
    for (ssize_t n; (n = ::recv(peer_.fd, bytes, sizeof bytes, 0)) > 0;) got.append(bytes, static_cast<std::size_t>(n));
    return got;
  }

  Nanoseconds now_ = seconds(1);
  OwnedDescriptor peer_;
  std::optional<Connection> connection_;
};

TEST_F(ConnectionTest, QueuesOutputBehindALineThatIsMadeInPieces) {
  int made = 0;
  connection_->queue("before\n", now_);
  connection_->queue_in_pieces("<", std::make_shared<Counted>(3, 2, made), ">\n", now_);
  connection_->queue("behind\n", now_);
  connection_->queue_in_pieces("[", std::make_shared<Counted>(2, 1, made), "]\n", now_);
  EXPECT_EQ(made, 0) << "nothing is made before there is time for it";
  EXPECT_FALSE(connection_->has_room());
  while (connection_->go_on(now_)) {
  }
  EXPECT_EQ(take(), "before\n<001122>\nbehind\n[34]\n");
  EXPECT_TRUE(connection_->has_room());
  EXPECT_FALSE(connection_->has_output());
}

TEST_F(ConnectionTest, NoMoreIsMadeThanThePeerTakes) {
  constexpr int kPieces = 200;
  int made = 0;
  connection_->queue_in_pieces("", std::make_shared<Counted>(kPieces, kPiece, made), "", now_);
  while (connection_->go_on(now_)) {
  }
  EXPECT_LT(made, 20) << "little more than a socket holds";
  EXPECT_TRUE(connection_->has_output());
  std::size_t taken = 0;
  for (int turns = 0; turns < 10 * kPieces && taken < kPieces * kPiece; ++turns) {
    taken += take().size();
    (void)connection_->flush(now_);
    (void)connection_->go_on(now_);
  }
  EXPECT_EQ(taken, kPieces * kPiece);
  EXPECT_EQ(made, kPieces);
}

TEST_F(ConnectionTest, AClosingConnectionSendsThePiecesFirst) {
  int made = 0;
  connection_->queue_in_pieces("", std::make_shared<Counted>(2, 1, made), "\n", now_);
  connection_->close_after();
  EXPECT_TRUE(connection_->flush(now_)) << "not over";
  while (connection_->go_on(now_)) {
  }
  EXPECT_FALSE(connection_->flush(now_));
  EXPECT_EQ(take(), "01\n");
}

TEST_F(ConnectionTest, ItsPatienceIsWithBytesThatWaitAndNotWithPiecesThatAreNotMade) {
  int made = 0;
  connection_->queue_in_pieces("", std::make_shared<Counted>(200, kPiece, made), "", now_);
  EXPECT_EQ(connection_->send_timeout(), kNever);
  while (connection_->go_on(now_)) {
  }
  EXPECT_EQ(connection_->send_timeout(), now_ + kStalledPeerLimit);
  EXPECT_FALSE(connection_->flush(now_ + kStalledPeerLimit));
}

TEST(Rights, AreTheHighestThatUserOrGroupsGive) {
  const gid_t groups[] = {100, 200};
  EXPECT_EQ(role_of(5, groups, 5, {}), Role::kConfigure);
  EXPECT_EQ(role_of(0, groups, 5, {}), Role::kConfigure);
  EXPECT_EQ(role_of(6, groups, 5, {}), Role::kNone);
  EXPECT_EQ(role_of(6, groups, 5, {gid_t{200}, {}, {}}), Role::kObserve);
  EXPECT_EQ(role_of(6, groups, 5, {gid_t{200}, gid_t{100}, {}}), Role::kOperate);
  EXPECT_EQ(role_of(6, groups, 5, {gid_t{200}, gid_t{100}, gid_t{300}}), Role::kOperate);
}

}  // namespace
}  // namespace chimera::control
