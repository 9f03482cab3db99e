// SPDX-License-Identifier: Apache-2.0
// Switches of a preemptive context without real-time levels, where the section alone excludes: also under the thread
// sanitizer. A late switch aborts; what a job reads holds all the same.
#include "tests/conformance/switch_by_threads.h"

namespace chimera::toy {
namespace {

TEST(SwitchingThreads, EachJobReadsTheProducerOfItsRelease) {
  switch_by_threads::run_until_done({}, milliseconds(2), milliseconds(22), 20);
}

TEST(SwitchingThreads, ARunThatEndsDuringASwitchSaysSoInItsReceipt) {
  switch_by_threads::run({}, milliseconds(2), 1, milliseconds(22), 1, {});
  const auto& receipts = switch_by_threads::seen.receipts;
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kRunEnded);
  switch_by_threads::expect_bindings_of_releases();
}

}  // namespace
}  // namespace chimera::toy
