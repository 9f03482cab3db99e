// SPDX-License-Identifier: Apache-2.0
// Properties of engine, wheels and motor, which all turn a wanted force into an actuator value.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Actuator {
  const char* component;
  const char* input;
  const char* output;
  const char* limit;
  double too_little, too_much;  // limits that are refused, N
  const char* refusal;
};

const Actuator kActuators[] = {
    {"engine", "fde", "gas", "full_gas", 0.5, 100001, "full_gas is 1 to 100000 N"},
    {"wheels", "fdw", "fb", "brake_limit", -1, 20001, "brake_limit is 0 to 20000 N"},
    {"motor", "fd", "fm", "force_max", -1, 50001, "force_max is 0 to 50000 N"},
};

struct AnyActuator : ::testing::TestWithParam<Actuator> {
  double cycle(double force) {
    rig.set(GetParam().input, force);
    EXPECT_TRUE(rig.cycle());
    return rig.get<double>(GetParam().output);
  }
  Rig rig{GetParam().component};
};

TEST_P(AnyActuator, LetsGoWhileTheConfigurationIsIllegalAndWhenItIsSwitchedOff) {
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<double>(GetParam().output), 0);  // before the first cycle
  EXPECT_GT(cycle(1000), 0);
  rig.illegal(true);
  EXPECT_EQ(cycle(1000), 0);
  EXPECT_EQ(cycle(std::nan("")), 0);
  rig.illegal(false);
  EXPECT_GT(cycle(1000), 0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.get<double>(GetParam().output), 0);
}

TEST_P(AnyActuator, AForceThatIsNotFiniteIsAFaultAndLeavesTheOutput) {
  ASSERT_TRUE(rig.init());
  const double before = cycle(1000);
  for (double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    rig.set(GetParam().input, wrong);
    EXPECT_EQ(rig.cycle().text, std::string(GetParam().input) + " is not finite");
    EXPECT_EQ(rig.get<double>(GetParam().output), before);
  }
}

TEST_P(AnyActuator, RefusesALimitOutsideItsRange) {
  for (double wrong : {GetParam().too_little, GetParam().too_much, std::nan("")}) {
    rig.set(GetParam().limit, wrong);
    EXPECT_EQ(rig.init().text, GetParam().refusal) << wrong;
    EXPECT_EQ(rig.reinit().text, GetParam().refusal) << wrong;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, AnyActuator, ::testing::ValuesIn(kActuators),
                         [](const auto& one) { return std::string(one.param.component); });

}  // namespace
}  // namespace chimera
