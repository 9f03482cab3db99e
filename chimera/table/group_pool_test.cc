// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/group_pool.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "chimera/table/never_written.h"
#include "chimera/table/slot.h"

namespace chimera {
namespace {

constexpr TaskId kOld{0u}, kNew{1u}, kReader{2u};

struct PoolTest : testing::Test {
  PoolTest() {
    groups[0].link = {0, 80, 64};
    groups[1].link = {0, 16, 1024};
  }
  std::array<PooledGroup, 2> groups;
  GroupPool pool{groups};
  std::array<Adoption, 3> tasks{Adoption{"pid_old", true, 1}, Adoption{"pid_new", false, 0}, Adoption{"arm", true, 1}};

  std::string waiting_for(std::uint32_t bytes = 80) {
    const auto taken = pool.take(kNew, bytes, tasks);
    return taken ? "taken" : std::string(taken.error().message.view());
  }
};
using GroupPoolTest = PoolTest;

TEST_F(GroupPoolTest, TakesTheSmallestGroupThatIsLargeEnough) {
  EXPECT_EQ(pool.take(kOld, 8, tasks).value(), GroupId(1u));
  EXPECT_EQ(pool.take(kNew, 8, tasks).value(), GroupId(0u));
  EXPECT_EQ(pool.group(GroupId(1u)).writer, kOld);
}

TEST_F(GroupPoolTest, ReusesAfterBothConditionsInEitherOrder) {
  for (const bool writer_first : {true, false}) {
    tasks[kReader.index].generation = 1;
    tasks[kOld.index] = {"pid_old", true, 1};
    const GroupId id = pool.take(kOld, 80, tasks).value();
    pool.retire(id, 2);
    EXPECT_EQ(pool.reclaim(tasks), 0u);
    if (writer_first) {
      pool.writer_ended(id, WriterEnd::kAcknowledgedOff);
      tasks[kOld.index].is_on = false;
    } else {
      tasks[kOld.index].is_on = false;
      tasks[kReader.index].generation = 2;
    }
    EXPECT_EQ(pool.reclaim(tasks), 0u);
    if (writer_first) tasks[kReader.index].generation = 2;
    else pool.writer_ended(id, WriterEnd::kProvedDead);
    EXPECT_EQ(pool.reclaim(tasks), 1u);
    EXPECT_EQ(pool.group(id).state, PooledGroup::State::kFree);
  }
}

TEST_F(GroupPoolTest, AGroupStillInUseIsNeverReclaimedThoughItsWriterEnded) {
  const GroupId id = pool.take(kOld, 80, tasks).value();
  pool.writer_ended(id, WriterEnd::kProvedDead);
  tasks[kReader.index].generation = 99;
  tasks[kOld.index].is_on = false;
  EXPECT_EQ(pool.reclaim(tasks), 0u) << "consumers still look at its last outputs";
  pool.retire(id, 3);
  EXPECT_EQ(pool.reclaim(tasks), 1u);
}

TEST_F(GroupPoolTest, ATaskThatIsOffHoldsNothingUp) {
  const GroupId id = pool.take(kOld, 80, tasks).value();
  pool.retire(id, 2);
  pool.writer_ended(id, WriterEnd::kAcknowledgedOff);
  tasks[kOld.index].is_on = false;
  tasks[kReader.index].is_on = false;
  EXPECT_EQ(pool.reclaim(tasks), 1u);
}

TEST_F(GroupPoolTest, SaysForWhomItWaits) {
  const GroupId id = pool.take(kOld, 80, tasks).value();
  EXPECT_EQ(waiting_for(), "no free group of 80 bytes for pid_new; group 0 is in use by pid_old");
  pool.retire(id, 2);
  EXPECT_EQ(waiting_for(), "no free group of 80 bytes for pid_new; group 0 waits for its writer pid_old to acknowledge "
                           "OFF or be proved dead");
  pool.writer_ended(id, WriterEnd::kAcknowledgedOff);
  tasks[kOld.index].is_on = false;
  EXPECT_EQ(waiting_for(),
            "no free group of 80 bytes for pid_new; group 0 waits for arm to adopt generation 2 (is at 1)");
  tasks[kReader.index].generation = 2;
  EXPECT_EQ(waiting_for(), "no free group of 80 bytes for pid_new; group 0 waits to be reclaimed");
  EXPECT_EQ(pool.reclaim(tasks), 1u);
  EXPECT_EQ(waiting_for(), "taken");
  EXPECT_EQ(waiting_for(81), "no free group of 81 bytes for pid_new; none of the 2 groups is that large");
}

TEST_F(GroupPoolTest, TheCounterGoesOnAtReuse) {
  struct alignas(kCacheLine) Memory { std::byte bytes[group_bytes(80)]{}; } memory;
  {
    GroupWriter old_writer(memory.bytes, 80);
    for (int i = 0; i < 5; ++i) old_writer.publish(Nanoseconds{i}, 1);
  }
  const GroupId id = pool.take(kOld, 80, tasks).value();
  pool.retire(id, 2);
  pool.writer_ended(id, WriterEnd::kAcknowledgedOff);
  tasks[kReader.index].generation = tasks[kOld.index].generation = 2;
  pool.reclaim(tasks);
  ASSERT_EQ(pool.take(kNew, 80, tasks).value(), id);
  GroupWriter new_writer(memory.bytes, 80);
  fill_never_written({new_writer.staging(), 80}, NeverWritten::kFloat64);
  new_writer.publish(Nanoseconds{0}, 0);  // the new incarnation begins never-written
  EXPECT_EQ(GroupReader(memory.bytes, 80).published()->sequence, 6u);
  EXPECT_EQ(GroupReader(memory.bytes, 80).published()->valid, 0u);
}

}  // namespace
}  // namespace chimera
