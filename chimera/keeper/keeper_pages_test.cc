// SPDX-License-Identifier: Apache-2.0
#include "chimera/keeper/keeper_pages.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

/// Pages of two rtpus and the manager, with both views of a process of the run.
class KeeperPagesTest : public ::testing::Test {
 protected:
  const KeeperPage& seen() const { return *reinterpret_cast<const KeeperPage*>(keeper_.bytes().data()); }
  DecisionPage& decision() { return *reinterpret_cast<DecisionPage*>(decision_.bytes().data()); }
  std::uint32_t rings(std::uint32_t peer) { return decision().bells[peer].word.load(); }

  KeeperPages pages_ = *KeeperPages::create(2, seconds(7));
  MemoryRegion keeper_ = *MemoryRegion::open_read_only(pages_.keeper_descriptor(), sizeof(KeeperPage));
  SharedPages decision_ = *SharedPages::open(pages_.decision_descriptor(), sizeof(DecisionPage));
};

TEST_F(KeeperPagesTest, BeginWithoutALivingPeer) {
  EXPECT_EQ(seen().origin, seconds(7));
  EXPECT_EQ(seen().n_rtpus, 2u);
  EXPECT_EQ(seen().ending, 0u);
  for (const auto& incarnation : seen().alive) EXPECT_EQ(incarnation, 0u);
}

TEST_F(KeeperPagesTest, AChangeOfALifeIsCountedAndRingsNoBell) {
  pages_.show_life(1, 4);
  EXPECT_EQ(seen().alive[1], 4u);
  EXPECT_EQ(decision().changes, 1u);
  pages_.show_life(1, 0);
  EXPECT_EQ(seen().alive[1], 0u);
  EXPECT_EQ(decision().changes, 2u);
  EXPECT_EQ(rings(1), 0u);
}

TEST_F(KeeperPagesTest, RingsOnlyEveryRtpuAndTheManager) {
  pages_.ring_all();
  for (std::uint32_t peer = 0; peer < kMaxPeers; ++peer) EXPECT_EQ(rings(peer), peer < 3 ? 1u : 0u) << peer;
}

TEST_F(KeeperPagesTest, ShowsTheFaceAndWakesAllForIt) {
  FacePage face;
  face.deaths = 2;
  face.last_signal = 11;
  face.lost_output = 32;
  pages_.show_face(face);
  EXPECT_EQ(seen().face_deaths, 2u);
  EXPECT_EQ(seen().face_signal, 11);
  EXPECT_EQ(seen().lost_output, 32);
  EXPECT_EQ(rings(2), 1u);
}

TEST_F(KeeperPagesTest, ShowTheGuardAndWakeAllForIt) {
  pages_.show_guard(4711, GuardState::kLate);
  EXPECT_EQ(seen().guard_pid, 4711);
  EXPECT_EQ(seen().guard_state, GuardState::kLate);
  EXPECT_EQ(rings(2), 1u);
}

TEST_F(KeeperPagesTest, ShowAnRtpuWithoutAGuardAsLongAsThatIncarnationLives) {
  pages_.show_life(1, 4);
  pages_.show_unguarded(1, 3, 24);  // a late word about its predecessor
  pages_.show_unguarded(7, 0, 24);  // no such rtpu
  EXPECT_EQ(seen().unguarded[1], 0);
  EXPECT_EQ(rings(2), 0u);
  pages_.show_unguarded(1, 4, 24);
  EXPECT_EQ(seen().unguarded[1], 24);
  EXPECT_EQ(rings(2), 1u);
  pages_.show_life(1, 5);
  EXPECT_EQ(seen().unguarded[1], 0);
}

TEST_F(KeeperPagesTest, BeatsAndTheEndAreShown) {
  pages_.beat();
  pages_.beat();
  EXPECT_EQ(seen().beats, 2u);
  pages_.show_ending();
  EXPECT_EQ(seen().ending, 1u);
}

}  // namespace
}  // namespace chimera
