// SPDX-License-Identifier: Apache-2.0
// A component in C as the papers write it (PBO_PAPER in chimera/task/pbo.h).
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(CPaper, InitReturnsItsLocalStateOr0) {
  Rig rig("t_paper");
  const RigAnswer made = rig.init();
  EXPECT_TRUE(made) << made.text;
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.init().text, "Init returned 0, which says that it failed");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.init().text, "it is 2 ms");
}

TEST(CPaper, AModuleWithoutPortsHasNone) {
  const chimera_component& made = linked_component("t_paper");
  EXPECT_EQ(made.n_ports, 0u);
  EXPECT_EQ(made.n_orders, 0u);
  EXPECT_EQ(made.n_choices, 0u);
  EXPECT_EQ(made.ports, nullptr);
}

}  // namespace
}  // namespace chimera
