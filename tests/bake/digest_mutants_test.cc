// SPDX-License-Identifier: Apache-2.0
// A digest shows the smallest differences. Compiled with the tables of the servo: tests/bake/CMakeLists.txt.
#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/executive/baked.h"
#include "tests/bake/baked_run.h"

namespace chimera::digest_mutants_test {

std::string original() { return digest_of(baked::kSpec, baked::kRun.acts, baked::kRun.duration); }

TEST(DigestMutants, TheLastBitOfAGainIsSeen) {
  std::vector<GivenSpec> given(baked::kSpec.operators.begin(), baked::kSpec.operators.end());
  std::vector<std::byte> value(given[0].value.begin(), given[0].value.end());
  value[0] ^= std::byte{1};  // the lowest byte comes first
  given[0].value = value;
  ApplicationSpec mutant = baked::kSpec;
  mutant.operators = given;
  EXPECT_NE(digest_of(mutant, baked::kRun.acts, baked::kRun.duration), original());
}

TEST(DigestMutants, OneJobMoreIsSeen) {
  std::vector<ScriptAct> acts(baked::kRun.acts.begin(), baked::kRun.acts.end());
  ScriptAct& off = acts.back();
  ASSERT_EQ(off.signal, Signal::kOff);
  off.at += baked::kSpec.tasks[off.task.index].period;
  EXPECT_NE(digest_of(baked::kSpec, acts, baked::kRun.duration), original());
}

// Sums of products are rounded once instead of twice.
TEST(DigestMutants, ContractedOperationsAreSeen) {
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "the processor has no fused multiply-add";
  EXPECT_NE(digest_of(baked::kSpec, baked::kRun.acts, baked::kRun.duration, {{"pid_joint", CONTRACTED_OBJECT}}),
            original());
}

TEST(DigestMutants, TheSameRunTwiceIsNoDifference) { EXPECT_EQ(original(), original()); }

}  // namespace chimera::digest_mutants_test
