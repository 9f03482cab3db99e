// SPDX-License-Identifier: Apache-2.0
#include "chimera/component_test/inputs.h"

#include <algorithm>
#include <cmath>

#include "chimera/component_test/testing/test_component.h"

namespace chimera::component_test {
namespace {

LibraryEntry two_inputs() {
  return component({ranged(port("q", CHIMERA_IN_VAR, "rad", "[2]"), -1, 3), port("v", CHIMERA_IN_VAR, "m/s"),
                    port("y", CHIMERA_OUT_VAR, "1")});
}

Result<Inputs> read(const std::string& text, std::vector<std::string> names = {}, std::size_t least = 1) {
  return Inputs::recorded(form_of(two_inputs()), text, "run.csv", names, milliseconds(10), least);
}

std::string refusal(const std::string& text) {
  const auto inputs = read(text);
  if (inputs) return "accepted";
  return std::string(inputs.error().where.c_str()) + ": " + inputs.error().message.c_str();
}

TEST(InputForm, NamesEveryNumber) {
  std::string names;
  for (const InputChannel& channel : form_of(two_inputs()).channels) names += channel.name + " ";
  EXPECT_EQ(names, "q[0] q[1] v ");
}

TEST(Generated, StaysInTheDeclaredRangeReachesItsEndsAndRepeats) {
  const InputForm form = form_of(two_inputs());
  const Inputs inputs = Inputs::generated(form, 7, 1000), again = Inputs::generated(form, 7, 1000);
  const Inputs other = Inputs::generated(form, 8, 1000);
  double least = 100, most = -100;
  bool differs = false;
  for (std::size_t i = 0; i < inputs.rows(); ++i) {
    const double q = form.get(form.channels[0], inputs.row(i));
    least = std::min(least, q);
    most = std::max(most, q);
    EXPECT_TRUE(std::ranges::equal(inputs.row(i), again.row(i)));
    differs = differs || !std::ranges::equal(inputs.row(i), other.row(i));
  }
  EXPECT_EQ(least, -1);
  EXPECT_EQ(most, 3);
  EXPECT_TRUE(differs);
}

TEST(Generated, KeepsAPoseAUnitQuaternion) {
  PortDescriptor pose = port("pose", CHIMERA_IN_VAR, "1");
  pose.type = CHIMERA_STRUCT;
  pose.type_name = "Pose";
  pose.element_size = 56;
  pose.fields = {{"position", "m", CHIMERA_FLOAT64, 0, 3, 8}, {"orientation", "1", CHIMERA_FLOAT64, 24, 4, 8}};
  const InputForm form = form_of(component({pose}));
  EXPECT_EQ(form.get(form.channels[3], form.base), 1);
  const Inputs inputs = Inputs::generated(form, 1, 200);
  for (std::size_t i = 0; i < inputs.rows(); ++i) {
    double square = 0;
    for (std::size_t c = 3; c < 7; ++c) square += std::pow(form.get(form.channels[c], inputs.row(i)), 2);
    EXPECT_NEAR(square, 1, 1e-12);
  }
  EXPECT_EQ(form.channels[3].name, "pose.orientation[0]");
}

TEST(Recorded, HoldsEachRowUntilTheNext) {
  const InputForm form = form_of(two_inputs());
  const auto inputs = read("t,v,q[1]\n1,5,0.5\n1.025,,0.75\n1.04,6,\n");
  ASSERT_TRUE(inputs) << inputs.error().message.c_str();
  ASSERT_EQ(inputs->rows(), 5u);
  const auto value = [&](std::size_t row, std::size_t channel) {
    return form.get(form.channels[channel], inputs->row(row));
  };
  EXPECT_EQ(value(2, 2), 5);
  EXPECT_EQ(value(2, 1), 0.5);
  EXPECT_EQ(value(3, 2), 5);  // an empty field keeps the previous value
  EXPECT_EQ(value(3, 1), 0.75);
  EXPECT_EQ(value(4, 2), 6);
  EXPECT_EQ(value(4, 0), 1);  // no column: the value of the setup, the middle of the range
  EXPECT_EQ(read("t,v\n0,1\n", {}, 20)->rows(), 20u);
  const auto with_units = read("t(s),v(m/s),q[0](rad)\n0,7,0.5\n");
  ASSERT_TRUE(with_units) << with_units.error().message.c_str();
  EXPECT_EQ(form.get(form.channels[2], with_units->row(0)), 7);
}

TEST(Recorded, TakesTheNamesOfALogFromTheUser) {
  const auto inputs = read("t,in[0][0],in[0][1],in[1]\n0,0.1,0.2,3\n", {"q", "v"});
  ASSERT_TRUE(inputs) << inputs.error().message.c_str();
  const InputForm form = form_of(two_inputs());
  EXPECT_EQ(form.get(form.channels[1], inputs->row(0)), 0.2);
  EXPECT_EQ(form.get(form.channels[2], inputs->row(0)), 3);
}

TEST(Recorded, RefusesTextThatIsNoRecording) {
  EXPECT_EQ(refusal(""), "run.csv:1:1: no row of values");
  EXPECT_EQ(refusal("v,t\n"), "run.csv:1:1: the first column is 'v', expected 't(s)', the time in s");
  EXPECT_EQ(refusal("t(ms),v\n0,1\n"), "run.csv:1:1: the first column is 't(ms)', expected 't(s)', the time in s");
  EXPECT_EQ(refusal("0,1\n1,2\n"),
            "run.csv:1:1: is a row of numbers: the first line is a head, such as t(s),q[0](rad)");
  EXPECT_EQ(refusal("t;v\n0;0,5\n"),
            "run.csv:1:1: has ';' between its fields: write ',' there, and a decimal point in numbers");
  EXPECT_EQ(refusal("t,v\n0 ,1\n"), "run.csv:2:1: has a blank: write no blank beside a comma or in a field");
  EXPECT_EQ(refusal("\xEF\xBB\xBFt,v\r\n0,1\r\n"), "accepted");
  EXPECT_EQ(refusal("t,v\n"), "run.csv:2:1: no row of values");
  EXPECT_EQ(refusal("t,v,v\n0,1,1\n"), "run.csv:1:5: 'v' is there twice");
  EXPECT_EQ(refusal("t,q[2]\n0,1\n"), "run.csv:1:3: no in-var of the component is called 'q[2]'");
  EXPECT_EQ(refusal("t(s),v(deg)\n0,1\n"), "run.csv:1:6: 'v' is in deg, and the port takes m/s");
  EXPECT_EQ(refusal("t,v\n0,one\n"), "run.csv:2:3: 'one' is no number");
  EXPECT_EQ(refusal("t,v\n0,1,2\n"), "run.csv:2:1: 3 fields, expected 2");
  EXPECT_EQ(refusal("t,v\n1,1\n1,1\n"), "run.csv:3:1: the time does not grow");
  EXPECT_EQ(refusal("t,v\nnan,1\n"), "run.csv:2:1: the time does not grow");
  EXPECT_EQ(refusal("t,v\n,1\n"), "run.csv:2:1: the time does not grow");
  const std::string much(kMaxRecordingBytes + 1, 't');
  EXPECT_EQ(refusal(much), "run.csv:1:1: 16777217 bytes, at most 16777216 are read");
}

TEST(Spoil, PutsEachKindOfBadValueWhereItFits) {
  PortDescriptor whole = port("n", CHIMERA_IN_VAR, "1");
  whole.type = CHIMERA_INT32;
  whole.element_size = 4;
  const InputForm form = form_of(component({ranged(port("q", CHIMERA_IN_VAR, "rad"), 0, 1), whole}));
  const auto spoilt = [&](std::size_t kind, std::size_t channel) {
    std::vector<std::byte> row = form.base;
    EXPECT_TRUE(spoil(form, kind, row));
    return form.get(form.channels[channel], row);
  };
  EXPECT_TRUE(std::isnan(spoilt(0, 0)));
  EXPECT_EQ(spoilt(1, 0), HUGE_VAL);
  EXPECT_EQ(spoilt(2, 0), -HUGE_VAL);
  EXPECT_EQ(spoilt(3, 0), 12);
  EXPECT_EQ(spoilt(4, 1), INT32_MIN);
  std::vector<std::byte> nothing;
  EXPECT_FALSE(spoil(form_of(component({})), 0, nothing));
}

}  // namespace
}  // namespace chimera::component_test
