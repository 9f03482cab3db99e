// SPDX-License-Identifier: Apache-2.0
// Switches of a preemptive context with real-time levels, beside a task that computes half of the time: each job reads
// the producer of its release.
#include "tests/conformance/switch_by_threads.h"

namespace chimera::toy {
namespace {

TEST(SwitchingRealtime, EachJobReadsTheProducerOfItsRelease) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: the kernel does not order the jobs";
  ProcessorPlace place;
  place.cpu = last_cpu();
  place.ceiling = kCeiling;
  place.base = 30;
  switch_by_threads::run_until_done(place, milliseconds(1), milliseconds(11), 20);
}

}  // namespace
}  // namespace chimera::toy
