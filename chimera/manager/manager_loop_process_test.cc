// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/manager_loop.h"

#include <gtest/gtest.h>

#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/answer/value_json.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/runtime/task_word.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

TEST(ManagerLoop, BringsTheStartSetUp) {
  FakeSubsystem fake;
  fake.start_manager();
  EXPECT_TRUE(fake.until_on("law")) << fake.told("refused");
  EXPECT_TRUE(fake.until([&] { return !fake.told("started").empty(); }));
  EXPECT_EQ(fake.told("manager-started"), "manager started\n");
  EXPECT_EQ(fake.told("started"), "sensor filter law are ON\n");
  EXPECT_NE(fake.loop().state().own.block().memory().started_at, 0);
  EXPECT_NE(fake.told("state").find("law: OFF -> ON\n"), std::string::npos) << fake.told("state");
}

TEST(ManagerLoop, ANewManagerResumesAfterAKillAtAnyTime) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  ASSERT_TRUE(fake.until([&] { return !fake.told("started").empty(); }));  // otherwise its successor logs it
  const double tuned[] = {7, 8};
  fake.loop().state().own.publish_operator(0, std::as_bytes(std::span(tuned)), now());
  const std::uint64_t last = fake.loop().state().log.last();
  fake.kill_manager();
  fake.start_manager();
  ASSERT_TRUE(fake.until([&] { return fake.loop().is_ready(); }));
  ManagerState& state = fake.loop().state();
  ASSERT_TRUE(fake.until([&] { return state.log.first() == 1; })) << "it has the events of before";
  EXPECT_GE(state.log.last(), last + 1);
  EXPECT_EQ(state.log.at(last + 1).text, "manager started again, incarnation 2");
  EXPECT_EQ(fake.told("started"), "");
  const VariableReading kp = state.readings->read(*state.readings->find("kp"));
  EXPECT_EQ(numbers(kp.form, kp.value), (std::vector<double>{7, 8}));
  EXPECT_EQ(state.state(fake.task("law")), State::kOn);
  std::optional<subsystem::CommandAnswer> got;
  fake.loop().command(Signal::kOff, {fake.task("law")},
                        [&](const subsystem::CommandAnswer& answer) { got = answer; });
  ASSERT_TRUE(fake.until([&] { return got.has_value(); }));
  EXPECT_TRUE(got->is_accepted()) << got->refusal.text();
}

TEST(ManagerLoop, TheNextManagerReportsEventsFromTheGap) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  fake.kill_manager();
  fake.rtpu(0).fail(fake.task("filter"), "joint 3 at its limit");
  fake.start_manager();
  ASSERT_TRUE(fake.until([&] { return fake.loop().is_ready(); }));
  EXPECT_EQ(fake.told("fault"), "filter: cycle: joint 3 at its limit\n");
  EXPECT_EQ(fake.told("state"), "filter: ON -> ERROR\n");
}

TEST(ManagerLoop, TurnsTasksOnAgainAfterTheirRtpuOverwroteItsMemory) {
  for (const std::uint64_t word : {std::uint64_t{0xdeadbeef}, UINT64_MAX, std::uint64_t{1}}) {
    FakeSubsystem fake;
    fake.start_manager();
    ASSERT_TRUE(fake.until_on("law"));
    fake.rtpu(1).die_overwritten(word, 8);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(fake.step());  // it polls before it reads messages
    const Nanoseconds at = now();
    EXPECT_EQ(status_json(fake.loop().state(), at)["tasks"][2]["task"], "law");
    EXPECT_EQ(profile_json(fake.loop().state(), at)["tasks"].size(), 3u);
    fake.kill_rtpu(1, SIGSEGV);
    ASSERT_TRUE(fake.until([&] { return fake.loop().state().rtpus[1].restarts == 1; }));
    EXPECT_TRUE(fake.until_on("law")) << word;
  }
}

TEST(ManagerLoop, TheNextManagerKnowsTheTasksOfAnRtpuWithUnreadableMemory) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  fake.kill_manager();
  fake.rtpu(1).die_overwritten(0xdeadbeef);
  fake.kill_rtpu(1, SIGSEGV);
  fake.start_manager();
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().rtpus[1].restarts == 1; }));
  EXPECT_EQ(fake.told("fault"),
            "something in it has overwritten its memory (not a state variable table: the first 8 bytes are not "
            "CHIMTBL1)\n");
  EXPECT_TRUE(fake.until_on("law"));
  fake.kill_manager();  // tasks that were ON are goals now, and this memory is gone
  bool is_off = false;
  fake.start_manager();
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().rtpus[1].is_up; }));
  fake.loop().command(Signal::kOff, {fake.task("law")}, [&](const auto& answer) { is_off = answer.is_accepted(); });
  ASSERT_TRUE(fake.until([&] { return is_off; }));
  fake.kill_manager();
  fake.rtpu(1).die_overwritten(0xdeadbeef);
  fake.kill_rtpu(1, SIGSEGV);
  fake.start_manager();
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().state(fake.task("law")) == State::kOff; }));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(fake.step());
  EXPECT_EQ(fake.loop().state().state(fake.task("law")), State::kOff) << "as it was";
}

TEST(ManagerLoop, EndsALivingRtpuWithOverwrittenMemory) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  fake.kill_manager();
  fake.rtpu(1).die_overwritten(0xdeadbeef);
  fake.start_manager();  // it has no message about a death
  ASSERT_TRUE(fake.until([&] { return !fake.told("fault").empty(); }));
  EXPECT_EQ(fake.told("fault"),
            "something in it has overwritten its memory (not a state variable table: the first 8 bytes are not "
            "CHIMTBL1): its states and numbers are not shown, and it is ended\n");
  EXPECT_TRUE(fake.until([&] { return fake.killed == 1u; }));
  EXPECT_EQ(fake.loop().state().state(fake.task("law")), State::kError);
  fake.kill_rtpu(1, SIGKILL);
  EXPECT_TRUE(fake.until([&] { return fake.loop().state().rtpus[1].restarts == 1; }));
  EXPECT_TRUE(fake.until_on("law"));
}

TEST(ManagerLoop, ReportsTheNoteOfATaskInItsWords) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  fake.rtpu(0).leave_note(fake.task("filter"), "3 meshes left out");
  ASSERT_TRUE(fake.until([&] { return !fake.told("note").empty(); }));
  EXPECT_EQ(fake.told("note"), "filter: 3 meshes left out\n");
  EXPECT_EQ(fake.told("fault"), "");
}

TEST(ManagerLoop, ReportsFailuresOfTimeAsOneEventWithTheirCount) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  fake.rtpu(1).block().profile(fake.task("law")).missed = 3;
  ASSERT_TRUE(fake.until([&] { return !fake.told("miss").empty(); }));
  EXPECT_EQ(fake.told("miss"), "law: 3 deadlines missed\n");
  fake.rtpu(1).block().profile(fake.task("law")).missed = 4;
  fake.rtpu(1).block().profile(fake.task("law")).overrun = 2;
  ASSERT_TRUE(fake.until([&] { return !fake.told("overrun").empty(); }));
  EXPECT_EQ(fake.told("miss"), "law: 3 deadlines missed\nlaw: 1 deadline missed (4 in all)\n");
  EXPECT_EQ(fake.told("overrun"), "law: 2 cycles over budget\n");
}

TEST(ManagerLoop, ReportsImpossibleCountersAsAFaultAndNotAsNumbers) {
  FakeSubsystem fake;
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  fake.rtpu(1).block().profile(fake.task("law")).overrun = 6'510'615'555'426'900'570u;
  ASSERT_TRUE(fake.until([&] { return !fake.told("fault").empty(); }));
  EXPECT_EQ(fake.told("fault"),
            "something in it has overwritten its memory (the counters of law): its states and numbers are not shown, "
            "and it is ended\n");
  EXPECT_EQ(fake.told("overrun"), "");
  EXPECT_TRUE(fake.until([&] { return fake.killed == 1u; }));
}

}  // namespace
}  // namespace chimera::manager
