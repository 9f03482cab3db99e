// SPDX-License-Identifier: Apache-2.0
// 500 switches of a preemptive context with real-time levels, beside a task that computes half of the time: no cycle
// is lost, each job reads the producer of its release.
#include "tests/conformance/judged.h"
#include "tests/conformance/switch_by_threads.h"

namespace chimera::toy {
namespace {

using switch_by_threads::count;
using switch_by_threads::seen;

TEST(SwitchingRealtime, FiveHundredSwitchesLoseNoCycle) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  ProcessorPlace place;
  place.cpu = last_cpu();
  place.ceiling = kCeiling;
  place.base = 30;
  const auto got = judged(microseconds(500), [&] {
    switch_by_threads::run(place, milliseconds(1), 500, milliseconds(11));
    return true;
  });
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  ASSERT_EQ(seen.receipts.size(), 500u);
  EXPECT_EQ(count(SwitchEnd::kDone), 500);
  EXPECT_EQ(seen.lost, 0u);
  switch_by_threads::expect_bindings_of_releases();
  Nanoseconds longest, sum;
  for (const SwitchReceipt& receipt : seen.receipts) {
    if (receipt.end != SwitchEnd::kDone) continue;
    longest = std::max(longest, receipt.at - receipt.asked);
    sum += receipt.at - receipt.asked;
  }
  std::printf("from the request to the change: mean %lld us, longest %lld us\n",
              static_cast<long long>(sum.count / 500'000), static_cast<long long>(longest.count / 1000));
}

}  // namespace
}  // namespace chimera::toy
