// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/layout.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "chimera/table/slot.h"

namespace chimera {
namespace {

constexpr std::uint64_t kPlenty = 1u << 20;

struct Planned {
  explicit Planned(std::span<const GroupSpec> specs, std::uint64_t available = kPlenty)
      : groups(specs.size()),
        variables(TableLayout::count_variables(specs)),
        result(TableLayout::plan(specs, available, groups, variables)) {}
  std::vector<GroupPlace> groups;
  std::vector<VariablePlace> variables;
  Result<TableLayout> result;
};

const std::array kArm{VariableSpec{"q", 8, 6}, VariableSpec{"ready", 1, 1}, VariableSpec{"gain", 4, 3}};
const std::array kPid{VariableSpec{"tau", 8, 6}};
const std::array kBoth{GroupSpec{"arm", kArm}, GroupSpec{"pid", kPid}};

TEST(TableLayout, PutsValuesAtMultiplesOf8AndGroupsAtMultiplesOf64) {
  const Planned plan(kBoth);
  const TableLayout& layout = plan.result.value();
  const GroupPlace& arm = layout.group(GroupId(0u));
  EXPECT_EQ(arm.offset, 0u);
  EXPECT_EQ(arm.payload_bytes, 48u + 8u + 16u);
  const VariablePlace& ready = layout.variable(GroupId(0u), 1);
  EXPECT_EQ(ready.offset, 48u);
  EXPECT_EQ(ready.bytes, 1u);
  EXPECT_EQ(ready.bit, 1u);
  const VariablePlace& gain = layout.variable(GroupId(0u), 2);
  EXPECT_EQ(gain.offset, 56u);
  EXPECT_EQ(gain.bytes, 12u);
  EXPECT_EQ(gain.bit, 2u);
  const GroupPlace& pid = layout.group(GroupId(1u));
  EXPECT_EQ(pid.offset, group_bytes(72));
  EXPECT_EQ(pid.offset % 64, 0u);
  EXPECT_EQ(layout.variable(GroupId(1u), 0).group, GroupId(1u));
  EXPECT_EQ(layout.variable(GroupId(1u), 0).bit, 0u);
  EXPECT_EQ(layout.region_bytes(), group_bytes(72) + group_bytes(48));
  EXPECT_EQ(layout.variables().size(), 4u);
}

TEST(TableLayout, AGroupWithoutVariablesHasAHeaderOnly) {
  const std::array specs{GroupSpec{"logger", {}}};
  const Planned plan(specs);
  EXPECT_EQ(plan.result.value().group(GroupId(0u)).payload_bytes, 0u);
  EXPECT_EQ(plan.result.value().region_bytes(), group_bytes(0));
}

TEST(TableLayout, RefusesARegionThatIsTooSmallAndSaysByHowMuch) {
  const std::uint64_t needed = group_bytes(72) + group_bytes(48);
  EXPECT_TRUE(Planned(kBoth, needed).result.has_value());
  const Planned plan(kBoth, needed - 64);
  ASSERT_FALSE(plan.result.has_value());
  EXPECT_EQ(plan.result.error().message.view(),
            "the table needs 1152 bytes for 2 groups, the region has 1088: 64 too few");
}

TEST(TableLayout, RefusesMoreThan64VariablesInAGroup) {
  std::vector<VariableSpec> many(65, VariableSpec{"x", 8, 1});
  const std::array specs{GroupSpec{"big", many}};
  const Planned plan(specs);
  ASSERT_FALSE(plan.result.has_value());
  EXPECT_EQ(plan.result.error().message.view(), "big publishes 65 variables, at most 64 fit one group");
  many.resize(64);
  const std::array fits{GroupSpec{"big", many}};
  EXPECT_TRUE(Planned(fits).result.has_value());
}

TEST(TableLayout, RefusesAVariableWithoutBytes) {
  const std::array zero{VariableSpec{"x", 8, 0}};
  const std::array specs{GroupSpec{"arm", zero}};
  const Planned plan(specs);
  ASSERT_FALSE(plan.result.has_value());
  EXPECT_EQ(plan.result.error().message.view(), "arm.x has no bytes: 0 elements of 8 bytes");
}

TEST(TableLayout, RefusesSizesThatOverflow32Bits) {
  const std::array huge{VariableSpec{"a", 8, 1}, VariableSpec{"x", 1u << 31, 1u << 31}};
  const std::array specs{GroupSpec{"arm", huge}};
  const Planned plan(specs);
  ASSERT_FALSE(plan.result.has_value());
  EXPECT_EQ(plan.result.error().message.view(),
            "arm.x of 4611686018427387904 bytes brings its group to 4611686018427387912 bytes, at most 16777216 are "
            "allowed");
}

TEST(TableLayout, DifferentTablesHaveDifferentHashes) {
  const std::uint64_t hash = Planned(kBoth).result.value().hash();
  EXPECT_EQ(Planned(kBoth).result.value().hash(), hash);
  auto renamed = kArm;
  renamed[0].name = "p";
  auto wider = kArm;
  wider[2].max_count = 4;  // same places: 12 and 16 bytes take 16
  auto moved = kBoth;
  std::swap(moved[0], moved[1]);
  for (const auto& specs : {std::array{GroupSpec{"arm", renamed}, GroupSpec{"pid", kPid}},
                            std::array{GroupSpec{"arm", wider}, GroupSpec{"pid", kPid}},
                            std::array{GroupSpec{"leg", kArm}, GroupSpec{"pid", kPid}}, moved})
    EXPECT_NE(Planned(specs).result.value().hash(), hash);
}

}  // namespace
}  // namespace chimera
