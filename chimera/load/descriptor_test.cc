// SPDX-License-Identifier: Apache-2.0
#include "chimera/load/descriptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace chimera {
namespace {

int32_t construct(void*, chimera_fault*) { return CHIMERA_OK; }
void destroy(void*) {}
int32_t nothing(void*, const chimera_call*) { return CHIMERA_OK; }

chimera_port_decl port(const char* name, std::uint32_t kind, const char* unit = "1") {
  chimera_port_decl p{};
  p.name = name;
  p.doc = "";
  p.unit = unit;
  p.shape = "";
  p.frame = "";
  p.type_name = "";
  p.kind = kind;
  p.type = CHIMERA_FLOAT64;
  p.element_size = 8;
  p.max_instances = 1;
  return p;
}

/// A legal component with the ports x (in) and dx (out), for tests to break.
struct Sample {
  double zero = 0;
  std::vector<chimera_port_decl> ports{port("x", CHIMERA_IN_VAR, "U"), port("dx", CHIMERA_OUT_VAR, "U/s")};
  chimera_component component{};

  Sample() {
    component.abi_version = CHIMERA_ABI_VERSION;
    component.struct_size = sizeof(chimera_component);
    component.name = "tderiv";
    component.doc = "Time derivative of one signal.";
    component.default_rate_hz = 100;
    component.state_size = 4096;
    component.state_align = 8;
    component.construct = construct;
    component.destroy = destroy;
    component.methods[CHIMERA_CYCLE] = nothing;
    set_initial(1, &zero);
  }
  void set_initial(std::size_t i, const void* bytes, std::uint32_t count = 1) {
    ports[i].flags |= CHIMERA_PORT_HAS_INITIAL;
    ports[i].initial = bytes;
    ports[i].initial_count = count;
  }
  Result<Descriptor> described() {
    component.n_ports = static_cast<std::uint32_t>(ports.size());
    component.ports = ports.data();
    return describe(component);
  }
  std::string refusal() {
    const auto result = described();
    return result ? "accepted" : std::string(result.error().message.view());
  }
};

TEST(Describe, CopiesTheWholeDeclaration) {
  Sample sample;
  sample.ports[0].shape = "[n<=16]";
  const auto result = sample.described();
  ASSERT_TRUE(result) << result.error().message.view();
  EXPECT_EQ(result.value().name, "tderiv");
  EXPECT_TRUE(result.value().methods[CHIMERA_CYCLE]);
  EXPECT_FALSE(result.value().is_aperiodic());
  const PortDescriptor* x = result.value().port("x");
  ASSERT_NE(x, nullptr);
  EXPECT_EQ(x->extents, (std::vector<Extent>{{"n", 16}}));
  EXPECT_EQ(x->unit, "U");
  EXPECT_EQ(result.value().port("dx")->initial_count(), 1u);
  EXPECT_EQ(result.value().port("nowhere"), nullptr);
}

TEST(Describe, RefusesAnIllegalOrRepeatedName) {
  Sample sample;
  sample.ports[0].name = "X";
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port X: port \"X\" is no legal name: [a-z][a-z0-9_]*, at most 64 letters");
  sample.ports[0].name = "dx";
  EXPECT_EQ(sample.refusal(), "component tderiv: two ports are called dx");
  sample.component.name = "time derivative";
  EXPECT_EQ(sample.refusal(), "component time derivative: component \"time derivative\" is no legal name: "
                              "[a-z][a-z0-9_]*, at most 64 letters");
}

TEST(Describe, RefusesAnotherVersionOfTheInterface) {
  Sample sample;
  sample.component.abi_version = 7;
  EXPECT_EQ(sample.refusal(), "component: ABI version 7, this framework speaks 1");
}

TEST(Describe, TakesADeclarationFromBeforeThereWasABackgroundAndNoOtherSize) {
  Sample sample;
  sample.component.background = [](void*, chimera_fault*) -> std::int32_t { return CHIMERA_OK; };
  EXPECT_TRUE(sample.described().value().background);
  sample.component.struct_size = offsetof(chimera_component, background);
  EXPECT_FALSE(sample.described().value().background);  // what stands there is none of its
  sample.component.event_source = [](void*) -> std::int32_t { return 3; };
  sample.component.methods[CHIMERA_SYNC] = nothing;
  sample.component.struct_size = offsetof(chimera_component, event_source);
  EXPECT_TRUE(sample.described().value().background);
  EXPECT_FALSE(sample.described().value().event_source);
  const chimera_order nobody{"x", "nobody"};
  sample.component.orders = &nobody;
  sample.component.n_orders = 1;
  sample.component.struct_size = offsetof(chimera_component, n_orders);
  EXPECT_TRUE(sample.described().value().event_source);
  sample.component.n_orders = 0;
  const std::uint32_t size = sizeof(chimera_component);
  sample.component.struct_size = size;
  EXPECT_TRUE(sample.described().value().event_source);
  sample.component.struct_size = size + 8;
  EXPECT_EQ(sample.refusal(), "component: declaration of " + std::to_string(size + 8) + " bytes, expected " +
                                  std::to_string(size));
}

TEST(Describe, AnOrderStandsBetweenTwoConstantsOfOneKind) {
  Sample sample;
  sample.ports.push_back(port("low", CHIMERA_IN_CONST, "m"));
  sample.ports.push_back(port("high", CHIMERA_IN_CONST, "m"));
  chimera_order orders[] = {{"low", "high"}, {"x", "high"}};
  sample.component.orders = orders;
  sample.component.n_orders = 1;
  EXPECT_EQ(sample.described().value().port("high")->at_least, "low");
  EXPECT_EQ(sample.described().value().port("low")->at_least, "");
  const std::string kinds = "component tderiv: port high: at least \"low\": expected two in-consts of numbers, of one "
                            "type, unit and shape";
  sample.ports[3].unit = "s";
  EXPECT_EQ(sample.refusal(), kinds);
  sample.ports[3].unit = "m";
  sample.ports[2].kind = CHIMERA_IN_VAR;
  EXPECT_EQ(sample.refusal(), kinds);
  sample.ports[2].kind = CHIMERA_IN_CONST;
  sample.component.n_orders = 2;
  EXPECT_EQ(sample.refusal(), "component tderiv: port high: is at least two others");
  orders[0] = {"low", "heigh"};
  EXPECT_EQ(sample.refusal(), "component tderiv: no port \"heigh\" is there to be at least low");
  orders[0] = {"high", "high"};
  sample.component.n_orders = 1;
  EXPECT_EQ(sample.refusal(), "component tderiv: port high: at least \"high\": expected two in-consts of numbers, of "
                              "one type, unit and shape");
  sample.component.n_orders = 65;
  EXPECT_EQ(sample.refusal(), "component tderiv: has more orders than ports");
}

TEST(Describe, RefusesAnEventSourceWhoseEventsNobodyTakes) {
  Sample sample;
  sample.component.event_source = [](void*) -> std::int32_t { return 3; };
  EXPECT_EQ(sample.refusal(), "component tderiv: has an event source but no sync to take its events");
}

TEST(Describe, RefusesSizesThatDoNotFitTheType) {
  Sample sample;
  sample.ports[0].element_size = 4;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: float64 takes 8 bytes, declared are 4");
  sample.ports[0].type = CHIMERA_STRING;
  sample.ports[0].element_size = 0;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: an element of 0 bytes; a string takes 1 to 4096");
}

TEST(Describe, RefusesShapesThatDoNotParse) {
  Sample sample;
  sample.ports[0].shape = "[n]";
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port x: shape \"[n]\": the extent n needs a maximum, as in [n<=16]");
  sample.ports[0].shape = "[0]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[0]\": \"0\" is no whole number from 1 to 65536");
  sample.ports[0].shape = "6";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"6\": expected [6], [n<=16] or two of these");
  sample.ports[0].shape = "[2][2][2]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[2][2][2]\": more than 2 dimensions");
  sample.ports[0].shape = "[n...<=8][2]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[n...<=8][2]\": a shape variable stands alone");
  sample.ports[0].shape = "[...<=8]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[...<=8]\": \"\" is no name: [a-z][a-z0-9_]*");
  sample.ports[0].shape = "[300][300]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[300][300]\": more than 65536 elements");
}

TEST(Describe, AnExtentNamedLikeAPortMustBeAWholeConstant) {
  Sample sample;
  sample.ports[0].shape = "[dx<=3]";
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port x: shape \"[dx<=3]\": the port dx is no whole-number scalar constant");
  sample.ports.push_back(port("ndof", CHIMERA_IN_CONST));
  sample.ports[2].type = CHIMERA_INT32;
  sample.ports[2].element_size = 4;
  sample.ports[0].shape = "[ndof<=3]";
  EXPECT_EQ(sample.refusal(), "accepted");
  sample.ports[1].shape = "[ndof<=4]";
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port x: shape \"[ndof<=3]\": port dx gives ndof the maximum 4");
}

TEST(Describe, AShapeVariableIsNoConstantAndNoExtent) {
  Sample sample;
  sample.ports[0].shape = sample.ports[1].shape = "[n...<=64]";
  EXPECT_EQ(sample.refusal(), "accepted");
  sample.ports[1].shape = "[n<=64]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[n...<=64]\": port dx has n as an extent");
  sample.ports[1].shape = "";
  sample.ports.push_back(port("n", CHIMERA_IN_CONST));
  sample.ports[2].type = CHIMERA_INT32;
  sample.ports[2].element_size = 4;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: shape \"[n...<=64]\": the port n is one number, and no shape");
}

TEST(Describe, CountsEveryInstanceAgainstTheLimit) {
  Sample sample;
  sample.component.state_size = 1u << 20;
  for (int i = 0; i < 4; ++i) {
    static const char* const kNames[] = {"a", "b", "c", "d"};
    sample.ports.push_back(port(kNames[i], CHIMERA_IN_VAR));
    sample.ports.back().flags = CHIMERA_PORT_REPEATED;
    sample.ports.back().max_instances = 16;
  }
  EXPECT_EQ(sample.refusal(), "component tderiv: 66 ports, instances counted; at most 64 are allowed");
}

TEST(Describe, RefusesSafetyOnAnythingButAFloatingOutput) {
  Sample sample;
  sample.ports[0].flags = CHIMERA_PORT_SAFETY;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: safety is for out-vars, this is an in-var");
  sample.ports[0].flags = 0;
  sample.ports[1].flags = CHIMERA_PORT_SAFETY;
  sample.ports[1].type = CHIMERA_INT64;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: a safety port is float32 or float64, declared is int64");
}

TEST(Describe, RefusesAnUnorderedRangeAndAValueOutsideIt) {
  Sample sample;
  sample.ports[1].flags |= CHIMERA_PORT_HAS_RANGE;
  sample.ports[1].min = 2;
  sample.ports[1].max = 1;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: range from 2.000000 to 1.000000 is not ordered");
  sample.ports[1].max = 3;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value 0: 0.000000 is outside the range");
}

TEST(Describe, RefusesInitialValuesOfAWrongCountOrNone) {
  Sample sample;
  const double three[3] = {1, 2, std::numeric_limits<double>::quiet_NaN()};
  sample.ports[1].shape = "[4]";
  sample.set_initial(1, three, 3);
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value of 3 elements; expected 1 or 4");
  sample.ports[1].shape = "[3]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value 2: is not a number");
  sample.set_initial(0, three, 1);
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port x: an initial value on an in-var; it is for out-vars and in-consts");
}

TEST(Describe, RefusesFieldsThatOverlapOrLeaveTheElement) {
  Sample sample;
  chimera_field fields[2] = {{"u", "m", CHIMERA_FLOAT64, 0, 1, 8}, {"v", "m", CHIMERA_FLOAT64, 4, 1, 8}};
  sample.ports[0].type = CHIMERA_STRUCT;
  sample.ports[0].type_name = "Point";
  sample.ports[0].element_size = 16;
  sample.ports[0].fields = fields;
  sample.ports[0].n_fields = 2;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: field v: overlaps the field before it");
  fields[1].offset = 12;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: field v: ends beyond the element of 16 bytes");
  fields[1].offset = 8;
  EXPECT_EQ(sample.refusal(), "accepted");
}

TEST(Describe, RefusesALiveHalfOutsideTheState) {
  Sample sample;
  sample.ports[0].live_offset = 4090;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: its live half at offset 4090 with 1 instances does not lie "
                              "in the state of 4096 bytes");
}

TEST(Describe, LeavesTheBytesBetweenFieldsOut) {
  struct Padded {
    std::int32_t a;
    double b;
  };
  Padded first{7, 1.5}, second{7, 1.5};
  std::memset(&first, 0xaa, sizeof first);
  std::memset(static_cast<void*>(&second), 0x55, sizeof second);
  first.a = second.a = 7;
  first.b = second.b = 1.5;
  const chimera_field fields[2] = {{"a", "1", CHIMERA_INT32, 0, 1, 4}, {"b", "m", CHIMERA_FLOAT64, 8, 1, 8}};
  Sample sample;
  sample.ports[1].type = CHIMERA_STRUCT;
  sample.ports[1].type_name = "Padded";
  sample.ports[1].element_size = sizeof(Padded);
  sample.ports[1].fields = fields;
  sample.ports[1].n_fields = 2;
  sample.set_initial(1, &first);
  const auto one = sample.described();
  sample.set_initial(1, &second);
  const auto two = sample.described();
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one.value(), two.value());
}

TEST(Match, NamesTheFirstDifferenceAndBothSides) {
  const Descriptor file = Sample().described().value();
  Descriptor object = file;
  EXPECT_TRUE(match(file, object));
  object.doc = "Another sentence.";
  object.state_size = 8192;
  EXPECT_TRUE(match(file, object));
  EXPECT_EQ(fingerprint(file), fingerprint(object));
  object.ports[1].unit = "U";
  const auto unit = match(file, object);
  ASSERT_FALSE(unit);
  EXPECT_EQ(unit.error().message.view(),
            "component tderiv: port dx: unit: the descriptor says \"U/s\", the object says \"U\"");
  EXPECT_NE(fingerprint(file), fingerprint(object));
}

TEST(Match, NamesAMissingPortAndAnotherInitialValue) {
  const Descriptor file = Sample().described().value();
  Descriptor object = file;
  object.ports.pop_back();
  EXPECT_EQ(match(file, object).error().message.view(),
            "component tderiv: port dx: port: the descriptor says it exists, the object says nothing");
  EXPECT_EQ(match(object, file).error().message.view(),
            "component tderiv: port dx: port: the descriptor says nothing, the object says it exists");
  object = file;
  object.ports[1].initial.clear();
  EXPECT_EQ(match(file, object).error().message.view(),
            "component tderiv: port dx: initial value: the descriptor says bytes 0000000000000000, "
            "the object says none");
  EXPECT_NE(fingerprint(file), fingerprint(object));
}

}  // namespace
}  // namespace chimera
