// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/group.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

namespace chimera {
namespace {

struct AlignedMemory {
  explicit AlignedMemory(std::uint32_t payload) : lines(group_bytes(payload) / kCacheLine) {}
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(lines)); }
  struct alignas(kCacheLine) Line { std::byte b[kCacheLine]{}; };
  std::vector<Line> lines;
};

constexpr std::uint32_t kPayload = 80;
using Values = std::array<double, kPayload / sizeof(double)>;

Values filled_with(double x) {
  Values v;
  v.fill(x);
  return v;
}
const std::byte* bytes_of(const Values& v) { return reinterpret_cast<const std::byte*>(v.data()); }
std::byte* bytes_of(Values& v) { return reinterpret_cast<std::byte*>(v.data()); }

TEST(Group, ZeroedMemoryIsNeverWritten) {
  AlignedMemory memory(kPayload);
  GroupReader reader(memory.bytes().data(), kPayload);
  chimera_slot header{1, 1, 1, 1};
  Values values = filled_with(7);
  ASSERT_TRUE(reader.try_read(header, bytes_of(values)));
  EXPECT_EQ(header.sequence, 0u);
  EXPECT_EQ(header.valid, 0u);
  EXPECT_EQ(header.published_ns, 0);
  EXPECT_EQ(values, filled_with(0));
}

TEST(Group, ReaderGetsTheLatestPublicationWhole) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  GroupReader reader(memory.bytes().data(), kPayload);
  for (int k = 1; k <= 11; ++k) {
    writer.write(bytes_of(filled_with(k)), Nanoseconds{1000 * k}, 0b101);
    chimera_slot header{};
    Values values{};
    ASSERT_TRUE(reader.try_read(header, bytes_of(values)));
    EXPECT_EQ(values, filled_with(k));
    EXPECT_EQ(header.sequence, static_cast<std::uint64_t>(k));
    EXPECT_EQ(header.published_ns, 1000 * k);
    EXPECT_EQ(header.valid, 0b101u);
  }
  EXPECT_EQ(writer.sequence(), 11u);
}

TEST(Group, ReaderGetsThePartThatItAsksFor) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  GroupReader reader(memory.bytes().data(), kPayload);
  const Values written{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  for (int k = 1; k <= 5; ++k) writer.write(bytes_of(written), Nanoseconds{1000 * k}, 0b101);
  chimera_slot header{};
  Values values{};
  ASSERT_TRUE(reader.try_read_part(header, 3 * sizeof(double), std::span(bytes_of(values), 2 * sizeof(double))));
  EXPECT_EQ(values, (Values{3, 4}));
  EXPECT_EQ(header.sequence, 5u);
  EXPECT_EQ(header.published_ns, 5000);
  EXPECT_EQ(header.valid, 0b101u);
  ASSERT_TRUE(reader.try_read_part(header, kPayload, {}));
  EXPECT_EQ(header.sequence, 5u);
}

TEST(Group, StagedValuesAreNotSeenBeforePublish) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  GroupReader reader(memory.bytes().data(), kPayload);
  writer.write(bytes_of(filled_with(1)), Nanoseconds{1}, 1);
  std::memset(writer.staging(), 0xff, kPayload);
  chimera_slot header{};
  Values values{};
  ASSERT_TRUE(reader.try_read(header, bytes_of(values)));
  EXPECT_EQ(values, filled_with(1));
  EXPECT_EQ(header.sequence, 1u);
}

TEST(Group, StagingWalksRoundAllFourSlots) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  std::array<std::byte*, 5> places{};
  for (auto& place : places) {
    place = writer.staging();
    writer.publish(Nanoseconds{0}, 0);
  }
  for (std::size_t i = 0; i + 1 < places.size(); ++i)
    for (std::size_t j = i + 1; j < 4; ++j) EXPECT_NE(places[i], places[j]);
  EXPECT_EQ(places[4], places[0]);
  const auto slot_of = [&](std::byte* p) { return static_cast<std::size_t>(p - memory.bytes().data()); };
  EXPECT_EQ(slot_of(places[0]), kCacheLine + slot_stride(kPayload) + sizeof(chimera_slot));
}

TEST(Group, PrefillLetsOutputsStand) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  writer.write(bytes_of(filled_with(3)), Nanoseconds{1}, 1);
  writer.prefill();
  const double changed = 9;
  std::memcpy(writer.staging(), &changed, sizeof changed);
  writer.publish(Nanoseconds{2}, 1);
  GroupReader reader(memory.bytes().data(), kPayload);
  chimera_slot header{};
  Values values{};
  ASSERT_TRUE(reader.try_read(header, bytes_of(values)));
  Values expected = filled_with(3);
  expected[0] = 9;
  EXPECT_EQ(values, expected);
}

TEST(Group, PublishedPointsAtTheLatestSlotInPlace) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  GroupReader reader(memory.bytes().data(), kPayload);
  EXPECT_EQ(reader.published()->sequence, 0u);
  writer.write(bytes_of(filled_with(4)), Nanoseconds{5}, 0b11);
  const chimera_slot* slot = reader.published();
  EXPECT_EQ(slot->sequence, 1u);
  EXPECT_EQ(slot->valid, 0b11u);
  double first = 0;
  std::memcpy(&first, slot + 1, sizeof first);
  EXPECT_EQ(first, 4);
}

TEST(Group, SuccessorGoesOnWhereTheCounterStands) {
  AlignedMemory memory(kPayload);
  {
    GroupWriter writer(memory.bytes(), kPayload);
    writer.write(bytes_of(filled_with(1)), Nanoseconds{1}, 1);
    writer.write(bytes_of(filled_with(2)), Nanoseconds{2}, 1);
    std::memset(writer.staging(), 0xee, kPayload / 2);  // dies in the middle of a write
  }
  GroupReader reader(memory.bytes().data(), kPayload);
  chimera_slot header{};
  Values values{};
  ASSERT_TRUE(reader.try_read(header, bytes_of(values)));
  EXPECT_EQ(values, filled_with(2));
  GroupWriter successor(memory.bytes(), kPayload);
  EXPECT_EQ(successor.sequence(), 2u);
  successor.write(bytes_of(filled_with(3)), Nanoseconds{3}, 1);
  ASSERT_TRUE(reader.try_read(header, bytes_of(values)));
  EXPECT_EQ(header.sequence, 3u);
  EXPECT_EQ(values, filled_with(3));
}

TEST(Group, DistinguishesInitialValuesFromPublications) {
  AlignedMemory memory(kPayload);
  GroupWriter writer(memory.bytes(), kPayload);
  const GroupReader reader(memory.bytes().data(), kPayload);
  EXPECT_TRUE(reader.is_initial(0)) << "never written";
  for (std::uint64_t incarnation = 0; incarnation < 3; ++incarnation) {
    writer.publish_initial(Nanoseconds{1}, 1);
    EXPECT_TRUE(reader.is_initial(reader.published()->sequence));
    for (std::uint64_t n = 1; n <= 9; ++n) {
      writer.write(bytes_of(filled_with(1)), Nanoseconds{2}, 1);
      EXPECT_FALSE(reader.is_initial(reader.published()->sequence)) << n;
    }
  }
  EXPECT_EQ(writer.sequence(), 30u);
}

TEST(Group, PayloadOfAnySizeIsCopiedToTheByte) {
  for (std::uint32_t payload = 0; payload <= 130; ++payload) {
    AlignedMemory memory(payload);
    GroupWriter writer(memory.bytes(), payload);
    std::vector<std::byte> in(payload + 1), out(payload + 1);
    for (std::size_t i = 0; i < payload; ++i) in[i] = static_cast<std::byte>(i + 1);
    out[payload] = std::byte{0x5a};
    writer.write(in.data(), Nanoseconds{1}, 1);
    writer.prefill();
    writer.publish(Nanoseconds{2}, 1);
    GroupReader reader(memory.bytes().data(), payload);
    chimera_slot header{};
    ASSERT_TRUE(reader.try_read(header, out.data()));
    EXPECT_EQ(out[payload], std::byte{0x5a}) << payload;
    out[payload] = in[payload];
    EXPECT_EQ(in, out) << payload;
  }
}

TEST(GroupDeath, RefusesMemoryThatIsTooSmallOrNotAligned) {
  AlignedMemory memory(kPayload);
  EXPECT_DEATH(GroupWriter(memory.bytes().first(group_bytes(kPayload) - 1), kPayload), "memory.size\\(\\) >=");
  EXPECT_DEATH(GroupReader(memory.bytes().data() + 8, kPayload), "is_aligned");
}

}  // namespace
}  // namespace chimera
