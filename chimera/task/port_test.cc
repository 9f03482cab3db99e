// SPDX-License-Identifier: Apache-2.0
// The declarations that members make, and the access to their values.
#include "chimera/task/port.h"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>

#include "chimera/task/component.h"
#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {

struct Halved {
  double named;
  double forgotten;
};
template <>
struct Fields<Halved> {
  static constexpr const char* name = "Halved";
  static constexpr auto list = std::tuple{field("named", "m", &Halved::named)};
};

namespace {

struct Declared {
  In<double> scalar{"scalar", "U", range(-1, 2), doc = "a scalar"};
  Out<double[6]> list{"list", "N.m", initial = 0.5, safety};
  Out<std::int32_t[3]> counts{"counts", "1", initial = {1, 2, 3}};
  In<float[3][4]> fixed{"fixed", "1"};
  In<double[]> open{"open", "rad", "[ndof<=10]", frame = "base"};
  Out<Matrix<double>> open_matrix{"open_matrix", "kg", "[ndof<=10][ndof<=10]"};
  InConst<std::int32_t> ndof{"ndof", "1"};
  OutConst<bool> ready{"ready"};
  Resource device{"device", doc = "the device"};
  Many<In<double>, 5> many{"many*", "U"};
  Many<Out<double[]>, 2> many_lists{"many_lists*", "U", "[n<=3]"};
  In<Pose> pose{"pose", frame = "tool"};
  Out<Text<16>> state{"state", initial = "idle"};
  In<Any[]> any{"any", "U", "[n<=3]", type = "S"};
  void cycle() {}
};
CHIMERA_COMPONENT(Declared, "declared", "Ports of all sorts.");

const chimera_port_decl& port(const std::string& name) {
  const chimera_component& all = linked_component("declared");
  for (std::uint32_t i = 0; i < all.n_ports; ++i)
    if (all.ports[i].name == name) return all.ports[i];
  std::abort();
}

TEST(Port, DeclaresKindTypeUnitAndShape) {
  EXPECT_EQ(linked_component("declared").n_ports, 14u);
  EXPECT_EQ(port("scalar").kind, std::uint32_t{CHIMERA_IN_VAR});
  EXPECT_EQ(port("scalar").type, std::uint32_t{CHIMERA_FLOAT64});
  EXPECT_STREQ(port("scalar").unit, "U");
  EXPECT_STREQ(port("scalar").shape, "");
  EXPECT_STREQ(port("list").shape, "[6]");
  EXPECT_STREQ(port("fixed").shape, "[3][4]");
  EXPECT_EQ(port("fixed").type, std::uint32_t{CHIMERA_FLOAT32});
  EXPECT_STREQ(port("open").shape, "[ndof<=10]");
  EXPECT_STREQ(port("open_matrix").shape, "[ndof<=10][ndof<=10]");
  EXPECT_EQ(port("ndof").kind, std::uint32_t{CHIMERA_IN_CONST});
  EXPECT_EQ(port("ready").kind, std::uint32_t{CHIMERA_OUT_CONST});
  EXPECT_STREQ(port("ready").unit, "1");
  EXPECT_EQ(port("device").kind, std::uint32_t{CHIMERA_RESOURCE});
}

TEST(Port, DeclaresOptions) {
  EXPECT_EQ(port("scalar").flags, CHIMERA_PORT_HAS_RANGE);
  EXPECT_EQ(port("scalar").min, -1);
  EXPECT_EQ(port("scalar").max, 2);
  EXPECT_STREQ(port("scalar").doc, "a scalar");
  EXPECT_STREQ(port("open").frame, "base");
  EXPECT_EQ(port("list").flags, CHIMERA_PORT_HAS_INITIAL | CHIMERA_PORT_SAFETY);
  EXPECT_EQ(port("list").initial_count, 1u);
  EXPECT_EQ(*static_cast<const double*>(port("list").initial), 0.5);
  EXPECT_EQ(port("counts").initial_count, 3u);
  EXPECT_EQ(static_cast<const std::int32_t*>(port("counts").initial)[2], 3);
  EXPECT_STREQ(static_cast<const char*>(port("state").initial), "idle");
}

TEST(Port, RepeatedOnesLieOneAfterTheOther) {
  const chimera_port_decl& many = port("many");  // without its star
  EXPECT_EQ(many.flags, CHIMERA_PORT_REPEATED);
  EXPECT_EQ(many.max_instances, 5u);
  Rig rig("declared");
  rig.instances("many", 3);
  rig.set("many", 7.0, 0, 2);
  EXPECT_EQ(rig.get<double>("many", 0, 2), 7.0);
  EXPECT_STREQ(port("many_lists").shape, "[n<=3]");
}

TEST(Port, StructsDeclareAUnitForEachField) {
  ASSERT_EQ(port("pose").n_fields, 2u);
  EXPECT_STREQ(port("pose").type_name, "Pose");
  EXPECT_STREQ(port("pose").fields[0].unit, "m");
  EXPECT_EQ(port("pose").fields[1].offset, 24u);
  EXPECT_EQ(port("pose").fields[1].count, 4u);
  EXPECT_EQ(port("pose").element_size, sizeof(Pose));
}

TEST(Port, TypeVariablesHaveAName) {
  EXPECT_EQ(port("any").type, std::uint32_t{CHIMERA_ANY});
  EXPECT_STREQ(port("any").type_name, "S");
  EXPECT_EQ(port("any").element_size, 8u);
}

struct Reader {
  In<double> x{"x", "m"};
  In<double[]> list{"list", "m", "[n<=4]"};
  In<Matrix<double>> matrix{"matrix", "m", "[n<=4][2]"};
  Many<In<double>> many{"many*", "m"};
  Out<std::int64_t> age{"age", "ns"};
  Out<bool> fresh{"fresh"};
  Out<bool> valid{"valid"};
  Out<double> sum{"sum", "m"};
  Out<double> corner{"corner", "m"};
  InConst<int> reach{"reach", "1", initial = 0};
  void cycle() {
    *age = x.age().count;
    *fresh = x.fresh();
    *valid = x.valid();
    *sum = std::accumulate(list.begin(), list.end(), 0.0);
    for (const auto& one : many) *sum += *one;
    *corner = matrix(matrix.rows() - 1, 1);
    if (*reach == 1) *sum = list[list.size()];
    if (*reach == 2) *sum = matrix(0, 2);
    if (*reach == 3) *sum = *many[many.size()];
  }
};
CHIMERA_COMPONENT(Reader, "reader", "Reads.");

struct ReaderRig : Rig {
  ReaderRig() : Rig("reader") {
    extent("n", 3);
    instances("many", 2);
    for (std::size_t i = 0; i < 3; ++i) set("list", 1.0 + static_cast<double>(i), i);
    for (std::size_t i = 0; i < 6; ++i) set("matrix", 10.0 + static_cast<double>(i), i);
    set("many", 100.0, 0, 0);
    set("many", 200.0, 0, 1);
  }
};

TEST(Port, SizeIsTheExtentInUse) {
  ReaderRig rig;
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("sum"), 306.0);     // 1 + 2 + 3 of four, 100 + 200 of sixteen
  EXPECT_EQ(rig.get<double>("corner"), 15.0);   // row 2, column 1 of 3 x 2, without gaps
}

TEST(Port, AnIndexBeyondTheExtentIsAFault) {
  ReaderRig rig;
  rig.set("reach", 1);
  EXPECT_EQ(rig.cycle().text, "index 3 of a port that has 3");
  rig.set("reach", 2);
  EXPECT_EQ(rig.cycle().text, "index 2 of a port that has 2");
  rig.set("reach", 3);
  EXPECT_EQ(rig.cycle().text, "index 2 of a port that has 2");
}

TEST(Port, HasAgeFreshnessAndValidity) {
  ReaderRig rig;
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("valid"));
  EXPECT_EQ(rig.get<std::int64_t>("age"), kNever.count);
  rig.set("x", 1.0);
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  EXPECT_TRUE(rig.get<bool>("valid"));
  EXPECT_TRUE(rig.get<bool>("fresh"));
  EXPECT_EQ(rig.get<std::int64_t>("age"), 2'000'000);
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  EXPECT_FALSE(rig.get<bool>("fresh"));
  EXPECT_EQ(rig.get<std::int64_t>("age"), 4'000'000);
}

struct Heir {
  Out<double> x{"x", "m", initial = 1.0};
  Many<Out<double>, 2> list{"list*", "m"};
  Out<std::int64_t> age{"age", "ns"};
  Out<bool> is_handed_over{"is_handed_over"};
  Out<bool> is_outdated{"is_outdated"};
  void on() { tell(); }
  void cycle() { tell(); }
  void tell() {
    *age = x.inherited().count;
    *is_handed_over = x.is_handed_over();
    *is_outdated = list[1].is_outdated();
  }
};
CHIMERA_COMPONENT(Heir, "heir", "Outputs what it inherited.");

TEST(Port, AnOutVarHasTheAgeOfItsValueAtOn) {
  Rig rig("heir");
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<std::int64_t>("age"), kNever.count);
  EXPECT_FALSE(rig.get<bool>("is_handed_over"));
  EXPECT_FALSE(rig.get<bool>("is_outdated"));
  rig.inherit("x", milliseconds(30), milliseconds(15));
  rig.inherit("list", milliseconds(30));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<std::int64_t>("age"), milliseconds(30).count);
  EXPECT_TRUE(rig.get<bool>("is_handed_over")) << "2 periods";
  EXPECT_TRUE(rig.get<bool>("is_outdated")) << "above 10 ms and 2 periods";
  ASSERT_TRUE(rig.cycle(milliseconds(500)));
  EXPECT_EQ(rig.get<std::int64_t>("age"), milliseconds(30).count) << "the age at on";
  rig.inherit("x", kNever);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<std::int64_t>("age"), kNever.count);
  EXPECT_THROW(rig.inherit("y", {}), std::invalid_argument);
}

struct Twice {
  In<double> a{"same", "m"};
  In<double> b{"same", "m"};
  void cycle() {}
};
CHIMERA_COMPONENT(Twice, "twice", "One name, two ports.");

struct Elsewhere {
  std::unique_ptr<In<double>> away{new In<double>("away", "m")};
  void cycle() {}
};
CHIMERA_COMPONENT(Elsewhere, "elsewhere", "A port on the heap.");

struct Partly {
  In<Halved> x{"x"};
  void cycle() {}
};
CHIMERA_COMPONENT(Partly, "partly", "A struct port with a member left out.");

TEST(Port, ConstructionRefusesAnIllegalPort) {
  alignas(64) std::byte state[4096] = {};
  chimera_fault fault{};
  EXPECT_EQ(linked_component("twice").construct(state, &fault), CHIMERA_FAULT);
  EXPECT_STREQ(fault.text, "port same is declared twice");
  EXPECT_EQ(linked_component("elsewhere").construct(state, &fault), CHIMERA_FAULT);
  EXPECT_STREQ(fault.text, "port away must be a member of the component, not on the heap or static");
  EXPECT_EQ(linked_component("partly").construct(state, &fault), CHIMERA_FAULT);
  EXPECT_STREQ(fault.text, "port x carries a struct with a member that its Fields do not name");
}

}  // namespace
}  // namespace chimera
