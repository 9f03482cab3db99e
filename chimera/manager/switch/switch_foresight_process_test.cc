// SPDX-License-Identifier: Apache-2.0
// The report of a dry run about a switch: the way that it would go, and an `off` that would come late.
#include <gtest/gtest.h>

#include "chimera/control/receipt/switch_reason.h"
#include "chimera/manager/switch/switch_coordinator.h"
#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager::foresight_test {
namespace {

constexpr Asker kAnn{control::Role::kOperate, 4'000'000'001u};

TEST(SwitchForesight, ForeseesASlowSwitchIfATaskMightMissADeadline) {
  FakeSubsystem fake(R"(subsystem: fake
rtpus: {servo: {cpu: 3, policy: edf}}
tasks:
  sensor: {rtpu: servo, rate: 10 Hz, budget: 80 ms}
  other:  {component: sensor, rtpu: servo, rate: 10 Hz, offset: 90 ms, budget: 80 ms}
  like:   {component: sensor, rtpu: servo, rate: 10 Hz, budget: 70 ms}
configurations: {run: [sensor], late: [other], same: [like]}
start: run
)");
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("sensor"));
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().logic.is_settled(); }));
  SwitchCoordinator& switches = fake.loop().switches();
  const ForeseenSwitch foreseen = switches.foresee(tasks_of(fake.spec(), 1));
  EXPECT_EQ(foreseen.receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(foreseen.receipt.way.slow, kSlowForDeadlines);
  EXPECT_EQ(control::slow_text(foreseen.receipt, fake.spec()),
            "the transition from 'run' to 'late' is not schedulable on CPU 3: a cycle of task 'sensor' may take 400 "
            "ms, its deadline is 100 ms");
  EXPECT_EQ(foreseen.expected, milliseconds(160)) << "off and on, which were never called: their budgets";
  EXPECT_EQ(switches.foresee(tasks_of(fake.spec(), 2)).receipt.way.slow, 0) << "like for like";
  switches.ask({1, SwitchCause::kScript, {}}, kAnn, seconds(10), now(), [](const SwitchOutcome&) {});
  EXPECT_TRUE(switches.is_under_way());
  SwitchAgreement agreement(fake.loop().state().page.switching, {});
  EXPECT_EQ(agreement.order(agreement.plan(), 3, 3)->slow, kSlowForDeadlines);
}

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
