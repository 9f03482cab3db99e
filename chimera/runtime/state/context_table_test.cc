// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/state/context_table.h"

#include <gtest/gtest.h>

#include <cstring>

#include "chimera/runtime/testing/two_rtpus.h"

namespace chimera::context_table_test {
namespace {

double number(const GroupReader& reader, std::uint32_t offset) {
  double value;
  std::memcpy(&value, reinterpret_cast<const std::byte*>(reader.published() + 1) + offset, sizeof value);
  return value;
}

using testing::kMaker;
using testing::kTaker;

struct ContextTableTest : ::testing::Test, testing::TwoRtpus {
  ContextTable table;
};

TEST_F(ContextTableTest, HoldsTheOperatorVariablesOfAContextThatIsAlone) {
  ASSERT_TRUE(table.prepare(app.spec, {}, heap));
  ASSERT_EQ(table.operators().size(), 1u);
  EXPECT_EQ(number(table.operators()[0], 0), 0.5);
  table.set_operator(0, testing::bytes_of(2.5), milliseconds(3));
  EXPECT_EQ(number(table.operators()[0], 0), 2.5);
  EXPECT_EQ(table.operators()[0].published()->sequence, 2u);
  EXPECT_EQ(table.operators()[0].published()->published_ns, 3'000'000);
}

TEST_F(ContextTableTest, FindsBothGroupsInWhichAVariableMayStand) {
  ASSERT_TRUE(table.prepare(app.spec, {}, heap));
  TaskMemory memory = *TaskMemory::create(app.tasks[0], *app.components[0], heap);
  table.place_outputs(kMaker, memory, heap);
  const PortOf b{kMaker, 1};
  const VariableReader readers[] = {table.reader_of(b, 0), table.reader_of(b, 1)};
  EXPECT_NE(readers[0].reader.published(), readers[1].reader.published());
  for (const VariableReader& one : readers) {
    EXPECT_EQ(one.bit, 1u);
    EXPECT_EQ(number(one.reader, one.offset), 2.0) << "the initial value is published in both";
  }
}

TEST_F(ContextTableTest, LaysItsOwnGroupsInTheBytesThatItIsGiven) {
  const auto layout = PeerLayout::of(app.spec, 1, heap);
  ASSERT_TRUE(layout);
  const auto bytes = heap.take_bytes(layout->table().region_bytes(), kCacheLine);
  ContextPlace place;
  place.rtpu = RtpuId(1u);
  place.table = bytes;
  ASSERT_TRUE(table.prepare(app.spec, place, heap));
  EXPECT_TRUE(table.operators().empty()) << "they are the manager's";
  EXPECT_TRUE(table.everything().has(kTaker)) << "the plan of the whole application is known";
  const std::int32_t n = 7;
  GroupWriter writer = table.constant_writer(kMaker);
  std::memcpy(writer.staging() + table.constant_places(kMaker)[0].offset, &n, sizeof n);
  writer.publish(Nanoseconds{}, 1);
  const GroupPlace& at = layout->place(layout->constants(kMaker));
  const GroupReader reader(bytes.data() + at.offset, at.payload_bytes);
  EXPECT_EQ(reader.published()->sequence, 1u);
  EXPECT_EQ(table.constant_writer(kMaker).sequence(), 1u) << "goes on where the last writer stopped";
}

}  // namespace
}  // namespace chimera::context_table_test
