// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/transfer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

#include "chimera/table/never_written.h"

namespace chimera::transfer_test {
namespace {

constexpr std::uint32_t kPayload = 16;

struct alignas(kCacheLine) Group {
  std::array<std::byte, group_bytes(kPayload)> bytes{};
};
struct alignas(kCacheLine) Local {
  std::array<std::byte, local_group_bytes(kPayload)> bytes{};
};

void publish(GroupWriter& writer, double x) {
  const std::array<double, 2> values{x, -x};
  writer.write(reinterpret_cast<const std::byte*>(values.data()), Nanoseconds{static_cast<std::int64_t>(x)}, 0b11);
}

double first_value(const GroupInput& input) {
  double x = 0;
  std::memcpy(&x, input.values(), sizeof x);
  return x;
}

void set_counter(Group& group, std::uint64_t n) { std::memcpy(group.bytes.data(), &n, sizeof n); }

TEST(Transfer, DirectInputUsesThePublishedSlotInPlace) {
  Group group;
  GroupWriter writer(group.bytes, kPayload);
  std::array inputs{GroupInput::direct(GroupReader(group.bytes.data(), kPayload))};
  publish(writer, 1);
  EXPECT_EQ(transfer_in(inputs), 0u);
  EXPECT_EQ(first_value(inputs[0]), 1);
  EXPECT_GE(inputs[0].values(), group.bytes.data());
  EXPECT_LT(inputs[0].values(), group.bytes.data() + group.bytes.size());
  publish(writer, 2);
  EXPECT_EQ(first_value(inputs[0]), 1) << "latched until the next transfer";
  transfer_in(inputs);
  EXPECT_EQ(first_value(inputs[0]), 2);
  EXPECT_EQ(inputs[0].slot()->sequence, 2u);
}

TEST(Transfer, CopiedInputKeepsItsValuesWhileTheProducerGoesOn) {
  Group group;
  Local memory;
  GroupWriter writer(group.bytes, kPayload);
  LocalGroup local(GroupReader(group.bytes.data(), kPayload), memory.bytes);
  std::array inputs{GroupInput::copied(local)};
  publish(writer, 1);
  EXPECT_EQ(transfer_in(inputs), 0u);
  for (int x = 2; x < 10; ++x) publish(writer, x);
  EXPECT_EQ(first_value(inputs[0]), 1);
  EXPECT_EQ(inputs[0].slot()->sequence, 1u);
  transfer_in(inputs);
  EXPECT_EQ(first_value(inputs[0]), 9);
  EXPECT_EQ(inputs[0].slot()->published_ns, 9);
  EXPECT_EQ(inputs[0].slot()->valid, 0b11u);
}

TEST(Transfer, BothKindsSeeTheSame) {
  Group group;
  Local memory;
  GroupWriter writer(group.bytes, kPayload);
  const GroupReader reader(group.bytes.data(), kPayload);
  LocalGroup local(reader, memory.bytes);
  std::array inputs{GroupInput::direct(reader), GroupInput::copied(local)};
  for (int x = 1; x < 9; ++x) {
    publish(writer, x);
    transfer_in(inputs);
    EXPECT_EQ(std::memcmp(inputs[0].slot(), inputs[1].slot(), sizeof(chimera_slot) + kPayload), 0);
  }
  EXPECT_TRUE(inputs[0].is_direct());
  EXPECT_FALSE(inputs[1].is_direct());
}

TEST(LocalGroup, IsNeverWrittenUntilTheFirstRead) {
  Group group;
  Local memory;
  LocalGroup local(GroupReader(group.bytes.data(), kPayload), memory.bytes);
  fill_never_written(local.values_of_half(0), NeverWritten::kFloat64);
  fill_never_written(local.values_of_half(1), NeverWritten::kFloat64);
  EXPECT_EQ(local.slot()->sequence, 0u);
  EXPECT_EQ(local.slot()->valid, 0u);
  double x = 0;
  std::memcpy(&x, local.slot() + 1, sizeof x);
  EXPECT_TRUE(std::isnan(x));
}

TEST(LocalGroup, RebindingKeepsTheCopyUntilTheNextRead) {
  std::array<Group, 2> groups;
  Local memory;
  GroupWriter old_writer(groups[0].bytes, kPayload), new_writer(groups[1].bytes, kPayload);
  publish(old_writer, 1);
  publish(new_writer, 2);
  LocalGroup local(GroupReader(groups[0].bytes.data(), kPayload), memory.bytes);
  ASSERT_TRUE(local.refresh());
  local.rebind(GroupReader(groups[1].bytes.data(), kPayload));
  double x = 0;
  std::memcpy(&x, local.slot() + 1, sizeof x);
  EXPECT_EQ(x, 1);
  ASSERT_TRUE(local.refresh());
  std::memcpy(&x, local.slot() + 1, sizeof x);
  EXPECT_EQ(x, 2);
}

TEST(LocalGroup, AnyCounterReadsInsideTheGroup) {
  Group group;
  Local memory;
  GroupWriter writer(group.bytes, kPayload);
  publish(writer, 1);
  LocalGroup local(GroupReader(group.bytes.data(), kPayload), memory.bytes);
  set_counter(group, UINT64_MAX - 1);  // garbage from a broken process: slot 2 of this group, not beyond it
  EXPECT_TRUE(local.refresh());
  EXPECT_EQ(local.slot()->sequence, 0u);
}

}  // namespace
}  // namespace chimera::transfer_test
