// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/credible.h"

#include <gtest/gtest.h>

namespace chimera::manager {
namespace {

TEST(Credible, ACountIsCredibleUpToTheHighestRate) {
  Profile counted;
  EXPECT_TRUE(is_credible(counted, {}));
  counted.missed = counted.overrun = 900'000;
  counted.stale = 64 * 900'000;
  EXPECT_TRUE(is_credible(counted, {})) << "a second of the highest rate";
  counted.overrun = 6'510'615'555'426'900'570u;
  EXPECT_FALSE(is_credible(counted, seconds(86'400)));
}

TEST(Credible, NothingTookLongerThanTheWholeRunNorBeganBeforeTheClock) {
  Profile counted;
  counted.response.add(seconds(1));
  counted.start_delay.add(seconds(-1));
  counted.late[0] = counted.on_before = seconds(1);
  counted.on_since = {};
  EXPECT_TRUE(is_credible(counted, {}));
  const auto is_refused = [&counted](auto&& change) {
    Profile changed = counted;
    change(changed);
    return !is_credible(changed, {});
  };
  EXPECT_TRUE(is_refused([](Profile& p) { p.response.max = seconds(2); }));
  EXPECT_TRUE(is_refused([](Profile& p) { p.start_delay.min = {INT64_MIN}; }));
  EXPECT_TRUE(is_refused([](Profile& p) { p.execution[CHIMERA_ON].count = UINT64_MAX; }));
  EXPECT_TRUE(is_refused([](Profile& p) { p.late[2] = {INT64_MIN}; }));
  EXPECT_TRUE(is_refused([](Profile& p) { p.on_since = {-1}; }));
  EXPECT_TRUE(is_refused([](Profile& p) { p.on_before = {INT64_MAX}; }));
}

TEST(Credible, AFaultHasAMethodAnInstantOfTheRunAndAPossibleCount) {
  const Nanoseconds origin = seconds(1000), now = seconds(1010);
  const auto is_refused = [&](auto change) {
    FaultRecord fault;
    fault.count = 1;
    fault.at = seconds(1005);
    EXPECT_TRUE(is_credible(fault, origin, now));
    change(fault);
    return !is_credible(fault, origin, now);
  };
  EXPECT_TRUE(is_credible(FaultRecord{}, origin, now)) << "no fault yet";
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.count = UINT64_MAX; }));
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.notes = UINT64_MAX; }));
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.off_count = UINT64_MAX; }));
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.at = seconds(2000); }));
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.at = Nanoseconds{-1}; }));
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.method = static_cast<Method>(99); }));
  EXPECT_TRUE(is_refused([](FaultRecord& fault) { fault.off_method = static_cast<Method>(99); }));
}

TEST(Credible, ACountWithoutAValueIsNotCredible) {
  Profile counted;
  counted.start_delay.count = 1;
  counted.cycles = 7;
  EXPECT_EQ(credible(counted, {}).start_delay.count, 0u);
  EXPECT_EQ(credible(counted, {}).cycles, 7u);
  counted.stale = UINT64_MAX;
  EXPECT_EQ(credible(counted, {}).cycles, 0u);
}

}  // namespace
}  // namespace chimera::manager
