// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

TEST(UnitConvert, MakesKelvinOfCelsius) {
  SignalRig rig("unit_convert", 2);
  rig.set("factor", 1.0);
  rig.set("offset", 273.15);
  rig.set("x", 20.0, 0);
  rig.set("x", -273.15, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("y", 0), 293.15);  // computed by on
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y", 1), 0);
}

TEST(UnitConvert, RefusesAFactorOfNothingAndNaN) {
  SignalRig rig("unit_convert");
  for (double factor : {0.0, std::nan(""), HUGE_VAL}) {
    rig.set("factor", factor);
    EXPECT_EQ(rig.init().text, "factor must be finite and not 0");
  }
  rig.set("factor", 2.0);
  rig.set("offset", HUGE_VAL);
  EXPECT_EQ(rig.init().text, "offset must be finite");
  rig.set("offset", 0.0);
  ASSERT_TRUE(rig.init());
  rig.set("x", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "x is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_EQ(rig.step(4), 8);
}

}  // namespace
}  // namespace chimera
