// SPDX-License-Identifier: Apache-2.0
#include "chimera/load/descriptor.h"

#include <gtest/gtest.h>

#include "chimera/load/testing/test_declaration.h"

namespace chimera {
namespace {

using testing::nothing;
using testing::port;
using testing::Sample;

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

TEST(Describe, RefusesAnotherVersionOfTheInterface) {
  Sample sample;
  sample.component.abi_version = 7;
  EXPECT_EQ(sample.refusal(), "component: it was built for ABI 7, and this chimera needs ABI 1: rebuild it");
}

TEST(Describe, TakesADeclarationFromBeforeThereWasABackgroundAndNoOtherSize) {
  Sample sample;
  sample.component.background = [](void*, chimera_fault*) -> std::int32_t { return CHIMERA_OK; };
  EXPECT_TRUE(sample.described().value().background);
  sample.component.struct_size = offsetof(chimera_component, background);
  EXPECT_FALSE(sample.described().value().background);  // the bytes there do not belong to the declaration
  sample.component.event_source = [](void*) -> std::int32_t { return 3; };
  sample.component.methods[CHIMERA_SYNC] = nothing;
  sample.component.struct_size = offsetof(chimera_component, event_source);
  EXPECT_TRUE(sample.described().value().background);
  EXPECT_FALSE(sample.described().value().event_source);
  const chimera_order nobody{"x", "absent"};
  sample.component.orders = &nobody;
  sample.component.n_orders = 1;
  sample.component.struct_size = offsetof(chimera_component, n_orders);
  EXPECT_TRUE(sample.described().value().event_source);
  const chimera_choice words{"x", "a b"};
  sample.component.choices = &words;
  sample.component.n_choices = 1;
  sample.component.n_orders = 0;
  sample.component.struct_size = offsetof(chimera_component, n_choices);
  EXPECT_TRUE(sample.described().value().ports[0].one_of.empty());
  sample.component.n_choices = 0;
  const std::uint32_t size = sizeof(chimera_component);
  sample.component.struct_size = size;
  EXPECT_TRUE(sample.described().value().event_source);
  sample.component.struct_size = offsetof(chimera_component, host_size);
  sample.component.host_size = sizeof(chimera_host) + 8;
  EXPECT_TRUE(sample.described());  // the bytes there do not belong to the declaration
  sample.component.struct_size = size;
  EXPECT_EQ(sample.refusal(),
            "component: it was built with a newer chimera than this one: rebuild it, or install that chimera");
  sample.component.host_size = offsetof(chimera_host, request);
  EXPECT_TRUE(sample.described()) << "built before there were requests";
  sample.component.host_size = offsetof(chimera_host, safe_frame);
  EXPECT_TRUE(sample.described()) << "built before there were safe frames";
  sample.component.host_size = offsetof(chimera_host, configuration);
  EXPECT_TRUE(sample.described()) << "built before a component could read the configuration in force";
  sample.component.host_size = offsetof(chimera_host, incarnation);
  EXPECT_TRUE(sample.described()) << "built before a component could read the incarnation of its process";
  sample.component.host_size = sizeof(chimera_host);
  EXPECT_TRUE(sample.described());
  sample.component.struct_size = size + 8;
  EXPECT_EQ(sample.refusal(), "component: declaration of " + std::to_string(size + 8) + " bytes, expected " +
                                  std::to_string(size));
}

TEST(Describe, RefusesALiveHalfOutsideTheState) {
  Sample sample;
  sample.ports[0].live_offset = 4090;
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port x: its chimera_port at offset 4090 with 1 instances does not lie "
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
