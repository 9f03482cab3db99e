// SPDX-License-Identifier: Apache-2.0
// Structs, repeated ports and type variables in the C face (chimera/task/pbo.h).
#include <gtest/gtest.h>

#include <cstring>

#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

const chimera_port_decl& port(const char* component, const char* name) {
  const chimera_component& made = linked_component(component);
  for (std::uint32_t i = 0; i < made.n_ports; ++i)
    if (std::strcmp(made.ports[i].name, name) == 0) return made.ports[i];
  std::abort();
}

TEST(CParts, AStructIsDeclaredAsTheSameStructInCpp) {
  const chimera_port_decl &c = port("t_parts", "pose"), &cpp = port("t_struct", "pose");
  EXPECT_STREQ(c.type_name, cpp.type_name);
  EXPECT_EQ(c.type, cpp.type);
  EXPECT_EQ(c.element_size, cpp.element_size);
  ASSERT_EQ(c.n_fields, cpp.n_fields);
  for (std::uint32_t i = 0; i < c.n_fields; ++i) {
    EXPECT_STREQ(c.fields[i].name, cpp.fields[i].name);
    EXPECT_STREQ(c.fields[i].unit, cpp.fields[i].unit);
    EXPECT_EQ(c.fields[i].type, cpp.fields[i].type);
    EXPECT_EQ(c.fields[i].offset, cpp.fields[i].offset);
    EXPECT_EQ(c.fields[i].count, cpp.fields[i].count);
    EXPECT_EQ(c.fields[i].size, cpp.fields[i].size);
  }
}

TEST(CParts, RepeatedPortsAndTypeVariablesAreDeclaredAsInCpp) {
  EXPECT_EQ(port("t_parts", "in").flags, port("t_repeat", "in").flags);
  EXPECT_EQ(port("t_parts", "in").max_instances, 16u);
  EXPECT_EQ(port("t_parts", "out").flags, port("t_repeat", "out").flags);
  EXPECT_EQ(port("t_parts", "out").max_instances, 4u);
  EXPECT_EQ(port("t_parts", "x").type, port("t_generic", "x").type);
  EXPECT_STREQ(port("t_parts", "x").type_name, "T");
  EXPECT_EQ(port("t_parts", "x").element_size, 8u);
}

TEST(CParts, EachInstanceOfARepeatedPortHasValuesOfItsOwn) {
  Rig rig("t_parts");
  rig.instances("in", 2);
  rig.instances("gain", 2);
  rig.instances("out", 3);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t n = 0; n < 2; ++n) rig.set("in", static_cast<double>(10 * i + n), n, i);
  rig.set("gain", 3.0, 0, 1);
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<Text<64>>("label", 0, 0), "first");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("out", 0, 0), 1.0);
  EXPECT_EQ(rig.get<double>("out", 0, 1), 63.0);
  EXPECT_EQ(rig.get<double>("out", 0, 2), 0.0);
  EXPECT_EQ(rig.get<std::int32_t>("sizes", 0), 2);
  EXPECT_EQ(rig.get<std::int32_t>("sizes", 1), 3);
  EXPECT_EQ(rig.cycle().text, "the first input is not fresh");
}

TEST(CParts, AnyTypeIsCopiedByItsBytes) {
  Rig rig("t_parts");
  for (const char* name : {"x", "y"}) rig.type<std::int32_t>(name);
  rig.extent("n", 3);
  for (std::size_t i = 0; i < 16; ++i) rig.set("x", static_cast<std::int32_t>(i + 5), i);
  rig.set("in", 0.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int32_t>("y", 2), 7);
  EXPECT_NE(rig.get<std::int32_t>("y", 3), 8) << "beyond the extent in use";
  EXPECT_EQ(rig.get<std::int32_t>("sizes", 2), 4);
  EXPECT_EQ(rig.get<std::int32_t>("sizes", 3), std::int32_t{CHIMERA_INT32});
}

TEST(CParts, StructsAndMatricesGoThrough) {
  struct Battery {
    double voltage, cell[4];
    std::int32_t charges;
    bool charging;
    char maker[64];
  };
  Rig rig("t_parts");
  EXPECT_EQ(rig.get<Battery>("power").cell[3], 3.0);
  EXPECT_STREQ(rig.get<Battery>("power").maker, "acme");
  rig.set("pose", Pose{{0, 0, 1.5}, {1, 0, 0, 0}});
  rig.set("in", 0.0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<Battery>("power").voltage, 1.5);
  EXPECT_EQ(rig.get<Battery>("power").charges, 1);
  EXPECT_EQ(rig.get<std::int32_t>("sizes", 4), 3);
  EXPECT_EQ(rig.get<std::int32_t>("sizes", 5), 2);
}

}  // namespace
}  // namespace chimera
