// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/switch/takeover_receipts.h"

#include <gtest/gtest.h>

#include "chimera/control/receipt/receipt_json.h"
#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

constexpr const char* kText = R"(subsystem: fake
rtpus: {servo: {cpu: 0, policy: edf}, spare: {cpu: 1, policy: muf}}
tasks:
  sensor: {rtpu: servo, rate: 10 Hz}
  filter: {rtpu: servo, rate: 10 Hz}
  second: {component: filter, rtpu: spare, rate: 10 Hz, standby_for: filter, max_step: {y: 1 rad}}
configurations: {run: [sensor, filter]}
)";

struct TakeoverReceiptsTest : ::testing::Test {
  TakeoverReceiptsTest() { fake.start_manager(); }
  /// A takeover as the rtpu of `second` publishes it, some time ago.
  Takeover takeover(std::uint32_t number) {
    Takeover one;
    one.number = number;
    one.set = 0;
    one.from = fake.task("filter");
    one.was_death = true;
    one.lost = now() - milliseconds(5);
    one.at = one.lost + milliseconds(1);
    one.ended = one.lost + milliseconds(2);
    one.standby.task = fake.task("second");
    one.standby.move = TaskMove::kArrives;
    return one;
  }
  void tell(const Takeover& one) { fake.rtpu(1).block().takeovers().put(one); }
  const std::deque<std::string>& kept() { return fake.loop().receipts().kept(); }
  bool until_kept(std::size_t n) {
    return fake.until([&] { return kept().size() >= n && fake.loop().receipts().unfiled() == 0; });
  }
  Json receipt(std::size_t index) { return Json::parse(kept().at(index)); }

  FakeSubsystem fake{kText};
};

TEST_F(TakeoverReceiptsTest, EachIsFiledOnce) {
  tell(takeover(1));
  ASSERT_TRUE(until_kept(1));
  const Json one = receipt(0);
  EXPECT_EQ(one["number"], 1);
  EXPECT_EQ(one["way"], "takeover");
  EXPECT_EQ(one["from"], "run");
  EXPECT_EQ(one["asked_by"],
            Json({{"reaction", "standby_for"}, {"lost", "filter"}, {"by", "death"}, {"task", "second"}}));
  EXPECT_EQ(one["end"], "done");
  EXPECT_GT(one["wall_ns"].as_int64(), 1'600'000'000'000'000'000);
  EXPECT_EQ(one["at_ns"].as_int64() - one["asked_ns"].as_int64(), 1'000'000);
  EXPECT_EQ(one["tasks"].size(), 2u);
  tell(takeover(2));
  ASSERT_TRUE(until_kept(2));
  EXPECT_EQ(receipt(1)["number"], 2);
  for (int i = 0; i < 5; ++i) fake.step();
  EXPECT_EQ(kept().size(), 2u);
}

TEST_F(TakeoverReceiptsTest, AStepBeyondItsLimitIsAnEvent) {
  Takeover one = takeover(1);
  one.n_variables = 1;
  const ApplicationSpec& spec = fake.spec();
  for (std::size_t v = 0; v < spec.variables.size(); ++v)
    if (spec.variables[v].name == "y")
      one.variables[0].handover = {VariableId(v), {one.from, 0}, {one.standby.task, 0}};
  one.variables[0].step_of_cycle = {3, 1, true, true};
  tell(one);
  ASSERT_TRUE(until_kept(1));
  EXPECT_EQ(receipt(0)["variables"][0]["beyond"], true);
  EXPECT_EQ(fake.told("bump"),
            "bump: after takeover 1 the first cycle of task 'second' moved 'y' by 3 rad, limit 1 rad\n");
}

TEST_F(TakeoverReceiptsTest, ATakeoverIsAwaitedUntilItsRtpuDies) {
  Takeover one = takeover(1);
  one.ended = kNever;
  tell(one);
  for (int i = 0; i < 20; ++i) fake.step();
  EXPECT_EQ(kept().size(), 0u);
  fake.kill_rtpu(1, 9);
  ASSERT_TRUE(until_kept(1));
  EXPECT_EQ(receipt(0)["end"], "done");
  EXPECT_EQ(receipt(0)["ended_ns"], receipt(0)["at_ns"]);
}

TEST_F(TakeoverReceiptsTest, TheNextManagerFilesTakeoversFromTheGap) {
  tell(takeover(1));
  ASSERT_TRUE(until_kept(1));
  fake.kill_manager();
  tell(takeover(2));
  tell(takeover(3));
  fake.start_manager();
  ASSERT_TRUE(until_kept(3));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(receipt(i)["number"], i + 1);
  for (int i = 0; i < 5; ++i) fake.step();
  EXPECT_EQ(kept().size(), 3u);
}

TEST_F(TakeoverReceiptsTest, ATakeoverInTheJournalOfAPredecessorIsNotFiledTwice) {
  ASSERT_TRUE(fake.until([&] { return fake.loop().is_ready(); }));
  const Takeover one = takeover(1);
  SwitchReceipt written;
  TaskPart parts[2];
  written.tasks = parts;
  written.number = 1;
  write_receipt(one, written);
  SwitchJournal journal(fake.loop().state().own.block().journal());
  ASSERT_TRUE(journal.put(1, control::receipt_json(written, fake.spec(), fake.page().origin)));
  fake.kill_manager();
  tell(one);
  fake.start_manager();
  ASSERT_TRUE(until_kept(1));
  for (int i = 0; i < 5; ++i) fake.step();
  EXPECT_EQ(kept().size(), 1u);
  tell(takeover(2));
  ASSERT_TRUE(until_kept(2));
  EXPECT_EQ(receipt(1)["number"], 2);
}

TEST_F(TakeoverReceiptsTest, OnesThatWereOverwrittenAreCounted) {
  for (std::uint32_t n = 1; n <= TakeoverRing::kKept + 3; ++n) tell(takeover(n));
  ASSERT_TRUE(until_kept(TakeoverRing::kKept));
  EXPECT_EQ(fake.told("note"), "takeovers without a receipt: 3\n");
  EXPECT_EQ(receipt(TakeoverRing::kKept - 1)["number"], TakeoverRing::kKept);
}

TEST_F(TakeoverReceiptsTest, SkipsDamagedTakeoversOfADeadRtpu) {
  const auto broken = [&](std::uint32_t number, auto change) {
    Takeover one = takeover(number);
    change(one);
    tell(one);
  };
  const Nanoseconds later = now() + seconds(1000);
  broken(1, [](Takeover& one) { one.set = 7; });
  broken(2, [](Takeover& one) { one.from = TaskId(99u); });
  broken(3, [&](Takeover& one) { one.standby.task = fake.task("sensor"); });
  broken(4, [](Takeover& one) { one.end = static_cast<SwitchEnd>(200); });
  broken(5, [&](Takeover& one) { one.lost = later; });
  broken(6, [](Takeover& one) {
    one.n_variables = 4'000'000'000u;
    one.variables[15].handover.variable = VariableId(999u);
  });
  tell(takeover(7));
  ASSERT_TRUE(until_kept(1));
  EXPECT_EQ(kept().size(), 1u);
  EXPECT_EQ(receipt(0)["end"], "done");
}

}  // namespace
}  // namespace chimera::manager
