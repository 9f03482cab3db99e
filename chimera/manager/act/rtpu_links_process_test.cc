// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/act/rtpu_links.h"

#include <gtest/gtest.h>

#include <csignal>

#include "chimera/manager/switch/switch_coordinator.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/runtime/plan/switch_agreement.h"

namespace chimera::manager {
namespace {

// Both tasks produce x. `left` went OFF for `right`, its rtpu died, and the other rtpu has not undone the switch yet.
struct HalfUndone : ::testing::Test {
  HalfUndone() {
    fake.start_manager();
    const auto is_settled = [&] { return state().logic.is_settled(); };
    EXPECT_TRUE(fake.until_on("left") && fake.until(is_settled));
    EXPECT_TRUE(fake.until([&] { return state().state(fake.task("right")) == State::kOff; }));
    fake.loop().switches().ask({1, SwitchCause::kScript, {}}, {control::Role::kOperate, 1000}, seconds(10), now(),
                                 [](const SwitchOutcome&) {});
    SwitchAgreement agreement(fake.decision_page().switching, fake.page().origin);
    auto order = agreement.order(agreement.plan(), 2, 2);
    number = order->number;
    order->slow = kSlowForGap;
    agreement.announce(*order);
    fake.rtpu(0).block().set_status(fake.task("left"), {State::kOff, false, 1});
    fake.rtpu(1).block().set_status(fake.task("right"), {State::kOn, false, 1});
    fake.kill_rtpu(0, SIGKILL);
    EXPECT_TRUE(fake.until([&] { return state().rtpus[0].incarnation == 2 && state().rtpus[0].is_alive; }));
  }
  const ManagerState& state() { return fake.loop().state(); }
  void expect_to_wait() {
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(fake.step());
    EXPECT_EQ(fake.told("refused"), "") << "two would make x";
    EXPECT_FALSE(state().rtpus[0].is_up);
  }
  void be_over() {
    fake.rtpu(1).block().set_status(fake.task("right"), {State::kOff, false, 1});
    for (const std::uint32_t r : {0u, 1u}) fake.rtpu(r).block().head().switching.over = number;
  }

  FakeSubsystem fake{R"(subsystem: fake
rtpus: {servo: {cpu: 0, policy: edf}, spare: {cpu: 1, policy: edf}}
tasks:
  left:  {component: sensor, rtpu: servo, rate: 10 Hz}
  right: {component: sensor, rtpu: spare, rate: 10 Hz}
configurations: {a: [left], b: [right]}
start: a
)"};
  std::uint16_t number = 0;
};

TEST_F(HalfUndone, ADeadRtpuComesBackWhenTheOthersAreOverWithTheSwitch) {
  expect_to_wait();
  be_over();
  EXPECT_TRUE(fake.until_on("left"));
  EXPECT_EQ(state().state(fake.task("right")), State::kOff);
}

TEST_F(HalfUndone, TheNextManagerWaitsToo) {
  fake.rtpu(0).block().head().switching.over = number;  // it has nothing to undo
  fake.kill_manager();
  fake.start_manager();
  expect_to_wait();
  be_over();
  EXPECT_TRUE(fake.until_on("left"));
  EXPECT_EQ(state().state(fake.task("right")), State::kOff);
}

}  // namespace
}  // namespace chimera::manager
