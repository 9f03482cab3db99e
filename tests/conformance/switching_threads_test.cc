// SPDX-License-Identifier: Apache-2.0
// Switches of a preemptive context without real-time levels, where the section alone excludes: also under the thread
// sanitizer. A late switch aborts; what a job reads holds all the same.
#include "tests/conformance/switch_by_threads.h"

namespace chimera::toy {
namespace {

TEST(SwitchingThreads, EachJobReadsTheProducerOfItsRelease) {
  switch_by_threads::run_until_done({}, milliseconds(2), milliseconds(22), 20);
}

}  // namespace
}  // namespace chimera::toy
