// SPDX-License-Identifier: Apache-2.0
// One peer with a real process (testing/child.cc).
#include "chimera/keeper/kept_peer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "chimera/base/testing/await.h"
#include "chimera/keeper/keeper_pages.h"
#include "chimera/keeper/testing/child_folder.h"
#include "chimera/platform/shared_memory.h"

namespace chimera {
namespace {

const std::string kPrefix = "test-";

class KeptPeerTest : public ::testing::Test, public testing::ChildFolder {
 protected:
  void TearDown() override {
    peer_.signal(SIGKILL);
    peer_.wait(kHangLimit);
  }
  Result<void> start(const std::string& program, Nanoseconds now) {
    const int passed[] = {image_.descriptor(), pages_.decision_descriptor(), pages_.keeper_descriptor()};
    return peer_.start({program, passed, kPrefix}, now);
  }

  FrozenBytes image_ = *FrozenBytes::create("image", std::as_bytes(std::span("image", 5)));
  KeeperPages pages_ = *KeeperPages::create(2, {});
  KeptPeer peer_{1};
};

TEST_F(KeptPeerTest, AFailedStartEndsWith127AndUsesAnIncarnation) {
  EXPECT_FALSE(start("/nowhere/rtpu", seconds(3)));
  EXPECT_FALSE(start("/nowhere/rtpu", seconds(4)));
  EXPECT_FALSE(peer_.lives());
  EXPECT_EQ(peer_.life().kind, KeeperMessage::Kind::kEnded);
  EXPECT_EQ(peer_.life().index, 1u);
  EXPECT_EQ(peer_.life().incarnation, 2u);
  EXPECT_EQ(peer_.life().code, 127);
  EXPECT_EQ(peer_.life().at, seconds(4));
}

TEST_F(KeptPeerTest, PassesOnTheMemoryThatItMade) {
  ASSERT_TRUE(start(KEEPER_TEST_CHILD, seconds(3)));
  EXPECT_EQ(peer_.life().kind, KeeperMessage::Kind::kStarted);
  EXPECT_EQ(peer_.life().pid, peer_.pid());
  EXPECT_EQ(peer_.origin(), "test-1.1");
  peer_.pass_segment_to(peer_);  // nothing yet
  KeeperMessage message;
  EXPECT_TRUE(await_that([&] { return peer_.receive(message) == KeptPeer::Said::kSegment; }));
  peer_.pass_segment_to(peer_);
  EXPECT_TRUE(await_that([&] { return log().find("1.1 peer 1 1 by-1.1\n") != std::string::npos; })) << log();
}

TEST_F(KeptPeerTest, ReportsItsEndOnceAndKeepsItsMessages) {
  ASSERT_TRUE(start(KEEPER_TEST_CHILD, seconds(3)));
  EXPECT_TRUE(await_that([&] { return log().find("begin") != std::string::npos; }));
  order("1", "kill 5\nexit 3");
  ProcessEnd how;
  ASSERT_TRUE(await_that([&] { return peer_.has_ended(how); }));
  EXPECT_FALSE(peer_.has_ended(how));
  EXPECT_FALSE(peer_.lives());
  KeeperMessage message;
  EXPECT_EQ(peer_.receive(message), KeptPeer::Said::kSegment);
  EXPECT_EQ(peer_.receive(message), KeptPeer::Said::kMessage);
  EXPECT_EQ(message.kind, KeeperMessage::Kind::kEndChild);
  EXPECT_EQ(message.index, 5u);
  peer_.note_end(how, seconds(9));
  EXPECT_EQ(peer_.channel(), -1);
  EXPECT_EQ(peer_.receive(message), KeptPeer::Said::kNothing);
  EXPECT_EQ(peer_.life().code, 3);
  EXPECT_EQ(peer_.life().by_signal, 0u);
  EXPECT_EQ(peer_.life().at, seconds(9));
}

}  // namespace
}  // namespace chimera
