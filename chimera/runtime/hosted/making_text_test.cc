// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/making_text.h"

#include <gtest/gtest.h>

#include "chimera/runtime/making.h"

namespace chimera {
namespace {

TEST(MakingWord, NamesTheObjectAndItsTask) {
  std::atomic<std::uint32_t> cell{0};
  show_making(cell, 2, Making::kLoads);
  EXPECT_EQ(task_of_making(cell, 3), 2u);
  EXPECT_EQ(making_text(cell, "amp", "/lib/gain.so"), "while it loaded /lib/gain.so, the component of task 'amp'");
  show_making(cell, 0, Making::kConstructs);
  EXPECT_EQ(making_text(cell, "amp", "/lib/gain.so"),
            "while it constructed a state of /lib/gain.so, the component of task 'amp'");
  show_made(cell);
  EXPECT_EQ(task_of_making(cell, 3), UINT32_MAX);
}

TEST(MakingWord, AnInvalidWordNamesNoTask) {
  EXPECT_EQ(task_of_making(4u << 8 | 1u, 3), UINT32_MAX) << "no such task";
  EXPECT_EQ(task_of_making(0xdeadbeef, 256), UINT32_MAX);
}

}  // namespace
}  // namespace chimera
