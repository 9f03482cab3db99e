// SPDX-License-Identifier: Apache-2.0
// 500 switches of a preemptive context with real-time levels, beside a task that computes half of the time: no cycle
// is lost, each job reads the producer of its release. In short runs, so that the host rarely stalls in one: each is
// judged by itself.
#include "tests/conformance/judged.h"
#include "tests/conformance/switch_by_threads.h"

namespace chimera::toy {
namespace {

using switch_by_threads::count;
using switch_by_threads::seen;

TEST(SwitchingRealtime, FiveHundredSwitchesLoseNoCycle) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  constexpr int kSwitches = 500, kInARun = 10, kMostRuns = 3 * kSwitches / kInARun;
  constexpr Nanoseconds kGap = microseconds(100);  // a tenth of the period
  ProcessorPlace place;
  place.cpu = last_cpu();
  place.ceiling = kCeiling;
  place.base = 30;
  int done = 0, runs = 0;
  Nanoseconds longest, sum;
  for (; done < kSwitches && runs < kMostRuns; ++runs) {
    Witness witness;
    switch_by_threads::run(place, milliseconds(1), kInARun, milliseconds(11), static_cast<unsigned>(runs));
    if (witness.worst() > kGap) continue;
    ASSERT_EQ(seen.receipts.size(), static_cast<std::size_t>(kInARun));
    EXPECT_EQ(count(SwitchEnd::kDone), kInARun);
    EXPECT_EQ(seen.lost, 0u);
    switch_by_threads::expect_bindings_of_releases();
    done += kInARun;
    for (const SwitchReceipt& receipt : seen.receipts) {
      if (receipt.end != SwitchEnd::kDone) continue;
      longest = std::max(longest, receipt.at - receipt.asked);
      sum += receipt.at - receipt.asked;
    }
  }
  std::printf("%d runs not judged; from the request to the change: mean %lld us, longest %lld us\n",
              runs - done / kInARun, static_cast<long long>(sum.count / 1000 / std::max(done, 1)),
              static_cast<long long>(longest.count / 1000));
  if (done < kSwitches) GTEST_SKIP() << "not judged: host stalled in " << runs - done / kInARun << " of " << runs;
}

}  // namespace
}  // namespace chimera::toy
