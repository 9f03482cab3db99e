// SPDX-License-Identifier: Apache-2.0
// Switches of a preemptive context without real-time levels, where the section alone excludes: also under the thread
// sanitizer. What is late aborts and is not judged; what a job reads is.
#include "tests/conformance/switch_by_threads.h"

namespace chimera::toy {
namespace {

using switch_by_threads::count;
using switch_by_threads::seen;

TEST(SwitchingThreads, EachJobReadsTheProducerOfItsRelease) {
  switch_by_threads::run({}, milliseconds(2), 40, milliseconds(22));
  ASSERT_EQ(seen.receipts.size(), 40u);
  EXPECT_GT(count(SwitchEnd::kDone), 10);
  EXPECT_GT(seen.reader.size(), 50u);
  switch_by_threads::expect_bindings_of_releases();
}

}  // namespace
}  // namespace chimera::toy
