// SPDX-License-Identifier: Apache-2.0
// The report of a dry run about a switch: the way that it would go, and an `off` that would come late.
#include <gtest/gtest.h>

#include "chimera/control/receipt/switch_reason.h"
#include "chimera/manager/switch/switch_coordinator.h"
#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager::foresight_test {
namespace {

constexpr Asker kAnn{control::Role::kOperate, 4'000'000'001u};

TEST(SwitchForesight, ForeseesAnOffThatFitsNoGap) {
  FakeSubsystem fake(R"(subsystem: fake
rtpus: {servo: {cpu: 3, policy: edf}}
tasks:
  sensor: {rtpu: servo, rate: 100 Hz, budget: 500 us}
  filter: {rtpu: servo, rate: 100 Hz, offset: 5 ms, budget: 500 us}
  law:    {rtpu: servo, rate: 10 Hz, budget: 6 ms}
operator: {kp: [1 N.m/rad, 2 N.m/rad]}
configurations: {run: [sensor, filter, law], rest: [sensor, filter], least: [sensor]}
start: run
)");
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().logic.is_settled(); }));
  SwitchCoordinator& switches = fake.loop().switches();
  const ForeseenSwitch foreseen = switches.foresee(tasks_of(fake.spec(), 1));
  EXPECT_EQ(foreseen.receipt.way.slow, 0);
  EXPECT_EQ(foreseen.late_off, fake.task("law"));
  EXPECT_EQ(foreseen.needed, milliseconds(6));
  EXPECT_FALSE(switches.foresee(tasks_of(fake.spec(), 2)).late_off.is_valid()) << "a gap of 10 ms is left then";
}

}  // namespace
}  // namespace chimera::manager::foresight_test
