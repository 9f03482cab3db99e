// SPDX-License-Identifier: Apache-2.0
// The declarations that describe() and complete() refuse, rule by rule.
#include <gtest/gtest.h>

#include <limits>

#include "chimera/load/testing/test_declaration.h"

namespace chimera {
namespace {

using testing::port;
using testing::Sample;

TEST(DeclarationRules, RefusesAnIllegalOrRepeatedName) {
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

TEST(DeclarationRules, AnOrderStandsBetweenTwoConstantsOfOneKind) {
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
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port high: is declared to be at least two other ports; one is allowed");
  orders[0] = {"low", "heigh"};
  EXPECT_EQ(sample.refusal(), "component tderiv: no port \"heigh\" is there to be at least low");
  orders[0] = {"high", "high"};
  sample.component.n_orders = 1;
  EXPECT_EQ(sample.refusal(), "component tderiv: port high: at least \"high\": expected two in-consts of numbers, of "
                              "one type, unit and shape");
  sample.component.n_orders = 65;
  EXPECT_EQ(sample.refusal(), "component tderiv: has more orders than ports");
}

TEST(DeclarationRules, WordsBelongToAConstantOfText) {
  Sample sample;
  sample.ports.push_back(port("wave", CHIMERA_IN_CONST));
  sample.ports[2].type = CHIMERA_STRING;
  sample.ports[2].element_size = 8;
  chimera_choice choices[] = {{"wave", "sine square"}, {"wave", "step"}};
  sample.component.choices = choices;
  sample.component.n_choices = 1;
  EXPECT_EQ(sample.described().value().port("wave")->one_of, (std::vector<std::string>{"sine", "square"}));
  const char initial[8] = "step";
  sample.set_initial(2, initial);
  EXPECT_EQ(sample.refusal(), "component tderiv: port wave: initial value 0: \"step\" is none of its words");
  choices[0].words = "sine step";
  EXPECT_EQ(sample.refusal(), "accepted");
  choices[0].words = "sine  step";
  EXPECT_EQ(sample.refusal(), "component tderiv: port wave: the word \"\": expected text without a space");
  choices[0].words = "step step";
  EXPECT_EQ(sample.refusal(), "component tderiv: port wave: the word \"step\" is listed twice");
  choices[0].words = "step sawtooth";
  EXPECT_EQ(sample.refusal(), "component tderiv: port wave: the word \"sawtooth\" is longer than the port's 7 bytes");
  choices[0].words = "step";
  sample.component.n_choices = 2;
  EXPECT_EQ(sample.refusal(), "component tderiv: port wave: has two lists of words it may be; one is allowed");
  sample.component.n_choices = 65;
  EXPECT_EQ(sample.refusal(), "component tderiv: has more choices than ports");
  sample.component.n_choices = 1;
  choices[0].port = "wawe";
  EXPECT_EQ(sample.refusal(), "component tderiv: no port \"wawe\" is there to be one of some words");
  choices[0].port = "x";
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: one of some words: expected an in-const of text");
}

TEST(DeclarationRules, RefusesAnEventSourceWithoutSync) {
  Sample sample;
  sample.component.event_source = [](void*) -> std::int32_t { return 3; };
  EXPECT_EQ(sample.refusal(), "component tderiv: has an event source but no sync to take its events");
}

TEST(DeclarationRules, RefusesSizesThatDoNotFitTheType) {
  Sample sample;
  sample.ports[0].element_size = 4;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: float64 takes 8 bytes, declared are 4");
  sample.ports[0].type = CHIMERA_STRING;
  sample.ports[0].element_size = 0;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: an element of 0 bytes; a string takes 1 to 4096");
}

TEST(DeclarationRules, RefusesShapesThatDoNotParse) {
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

TEST(DeclarationRules, AnExtentNamedLikeAPortMustBeAWholeConstant) {
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

TEST(DeclarationRules, AShapeVariableIsNoConstantAndNoExtent) {
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

TEST(DeclarationRules, CountsEveryInstanceAgainstTheLimit) {
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

TEST(DeclarationRules, RefusesSafetyOnAnythingButAFloatingOutput) {
  Sample sample;
  sample.ports[0].flags = CHIMERA_PORT_SAFETY;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: safety is for out-vars, this is an in-var");
  sample.ports[0].flags = 0;
  sample.ports[1].flags = CHIMERA_PORT_SAFETY;
  sample.ports[1].type = CHIMERA_INT64;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: a safety port is float32 or float64, declared is int64");
}

TEST(DeclarationRules, SharedIsAResource) {
  Sample sample;
  sample.ports[1].flags = CHIMERA_PORT_SHARED;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: shared is for resources, this is an out-var");
}

TEST(DeclarationRules, IntermittentIsAnInVarWithoutADefault) {
  Sample sample;
  sample.ports[0].flags = CHIMERA_PORT_INTERMITTENT;
  EXPECT_EQ(sample.refusal(), "accepted");
  sample.ports[0].flags = CHIMERA_PORT_INTERMITTENT << 1;
  EXPECT_EQ(sample.refusal(), "component tderiv: port x: unknown flags");
  sample.ports[0].flags = 0;
  sample.ports[1].flags = CHIMERA_PORT_INTERMITTENT;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: intermittent is for in-vars without a default");
}

TEST(DeclarationRules, TheSafeStateIsOneBoolOrAResource) {
  const char* const refused =
      "component tderiv: port dx: the safe state: expected an out-var of one bool, or a resource that never moves";
  Sample sample;
  sample.ports[1].flags = CHIMERA_PORT_SAFE_STATE;
  EXPECT_EQ(sample.refusal(), refused) << "a number";
  sample.ports[1].type = CHIMERA_BOOL;
  sample.ports[1].element_size = 1;
  sample.ports[1].unit = "1";
  EXPECT_EQ(sample.refusal(), "accepted");
  sample.ports[1].shape = "[2]";
  EXPECT_EQ(sample.refusal(), refused) << "several";
  sample.ports[1].shape = "";
  sample.ports[1].kind = CHIMERA_IN_VAR;
  EXPECT_EQ(sample.refusal(), refused) << "an input";
}

TEST(DeclarationRules, RefusesAnUnorderedRangeAndAValueOutsideIt) {
  Sample sample;
  sample.ports[1].flags |= CHIMERA_PORT_HAS_RANGE;
  sample.ports[1].min = 2;
  sample.ports[1].max = 1;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: range from 2.000000 to 1.000000 is not ordered");
  sample.ports[1].max = 3;
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value 0: 0.000000 is outside the range");
}

TEST(DeclarationRules, RefusesInitialValuesOfAWrongCountOrNone) {
  Sample sample;
  const double three[3] = {1, 2, std::numeric_limits<double>::quiet_NaN()};
  sample.ports[1].shape = "[4]";
  sample.set_initial(1, three, 3);
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value of 3 elements; expected 1 or 4");
  sample.ports[1].shape = "[3]";
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value 2: is not a number");
  sample.set_initial(0, three, 1);
  EXPECT_EQ(sample.refusal(), "component tderiv: port dx: initial value 2: is not a number") << "x is optional";
  sample.ports[0].kind = CHIMERA_OUT_CONST;
  EXPECT_EQ(sample.refusal(),
            "component tderiv: port x: an initial value on an out-const; it is for out-vars, in-consts and in-vars "
            "that are not repeated");
}

TEST(DeclarationRules, RefusesFieldsThatOverlapOrLeaveTheElement) {
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

}  // namespace
}  // namespace chimera
