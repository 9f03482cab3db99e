// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

TEST(Offset, AddsItFromOnAndFollowsItWhileItRuns) {
  SignalRig rig("offset");
  rig.set("x", 2.0), rig.set("offset", 0.5);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("y"), 2.5);
  rig.set("offset", -1.0);
  EXPECT_EQ(rig.step(3), 2);
}

TEST(Offset, ElementByElement) {
  SignalRig rig("offset", 2);
  for (std::size_t i = 0; i < 2; ++i) rig.set("x", 1.0, i), rig.set("offset", static_cast<double>(i), i);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("y", 0), 1);
  EXPECT_EQ(rig.get<double>("y", 1), 2);
}

TEST(Offset, NamesAValueThatIsNotFiniteAndAbortsOnAnUnwrittenInput) {
  SignalRig rig("offset");
  rig.set("x", 1.0);
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  rig.set("offset", std::nan(""));
  EXPECT_EQ(rig.cycle().text, "offset is not a finite number");
  EXPECT_TRUE(rig.error());
  rig.set("offset", 1.0);
  EXPECT_EQ(rig.step(1), 2);
  rig.set("x", -HUGE_VAL);
  EXPECT_EQ(rig.cycle().text, "x is not a finite number");
}

}  // namespace
}  // namespace chimera
