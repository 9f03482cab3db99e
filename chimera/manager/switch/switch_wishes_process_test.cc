// SPDX-License-Identifier: Apache-2.0
// The manager's handling of the requests of rtpus; the test plays the rtpus.
#include "chimera/manager/switch/switch_wishes.h"

#include <gtest/gtest.h>

#include <csignal>

#include "chimera/control/receipt/receipt_file.h"
#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager::switch_wishes_test {
namespace {

constexpr std::uint16_t kRun = 0, kRest = 1;
constexpr Asker kAnn{control::Role::kOperate, 4'000'000'001u};

struct SwitchWishesTest : ::testing::Test {
  SwitchWishesTest() {
    fake.start_manager();
    EXPECT_TRUE(fake.until_on("law"));
    EXPECT_TRUE(fake.until([this] { return fake.loop().state().logic.is_settled(); }));
  }
  PlanWord plan() { return SwitchAgreement(page().switching, {}).plan(); }
  DecisionPage& page() { return fake.loop().state().page; }
  SwitchCoordinator& coordinator() { return fake.loop().switches(); }
  /// Requests a switch as a task of the rtpu does.
  void wish(std::uint32_t rtpu, std::uint16_t set, const char* task, SwitchCause cause = SwitchCause::kRequest) {
    SwitchWishWords& words = fake.rtpu(rtpu).block().head().wish;
    words.write(words.wish().next({set, cause, fake.task(task)}), {}, now());
  }
  /// `law` requests tasks.
  void wish_for(const TaskLists& lists) {
    SwitchWishWords& words = fake.rtpu(1).block().head().wish;
    words.write(words.wish().next({UINT32_MAX, SwitchCause::kRequest, fake.task("law"), lists}), lists, now());
  }
  void rounds(int n = 5) {
    for (int i = 0; i < n; ++i) ASSERT_TRUE(fake.step());
  }
  /// The rtpus carry out the order.
  void carry_out() {
    SwitchAgreement agreement(page().switching, fake.page().origin);
    const std::uint16_t number = agreement.plan().number;
    ASSERT_TRUE(agreement.propose(number, agreement.round_up(now() + milliseconds(1))));
    (void)agreement.agree(number, 0);
    ASSERT_TRUE(agreement.agree(number, 1));
    over();
    const bool is_rest = coordinator().leads_to({kRest, SwitchCause::kRequest, {}});
    fake.rtpu(0).block().set_status(fake.task("filter"), {is_rest ? State::kOff : State::kOn, false, 1});
    fake.rtpu(1).block().set_status(fake.task("law"), {is_rest ? State::kOff : State::kOn, false, 1});
    rounds();
  }
  void over() {
    for (const std::uint32_t r : {0u, 1u}) {
      fake.rtpu(r).block().switch_part().number = plan().number;
      fake.rtpu(r).block().head().switching.adopted = plan().number;
      fake.rtpu(r).block().head().switching.over = plan().number;
    }
  }

  /// The receipts in the file.
  std::vector<std::string> filed() const { return control::ReceiptFile(fake.state() + "/chimera/fake").last(1000); }

  FakeSubsystem fake;
};

TEST_F(SwitchWishesTest, AreCarriedOutAndNameTheRequester) {
  wish(1, kRest, "law", SwitchCause::kFault);
  rounds();
  EXPECT_EQ(plan().phase, SwitchPhase::kPrepared);
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', asked for by on_fault of law");
  carry_out();
  rounds();
  EXPECT_EQ(plan().number, 1) << "handled once";
  EXPECT_FALSE(coordinator().is_under_way());
  EXPECT_NE(fake.told("switch").find("by on_fault of law from 'run' to 'rest'"), std::string::npos)
      << fake.told("switch");
  ASSERT_TRUE(fake.until([this] { return filed().size() == 1; }));
  EXPECT_NE(filed()[0].find("\"asked_by\": {\"reaction\": \"on_fault\", \"task\": \"law\"}"), std::string::npos)
      << filed()[0];
}

TEST_F(SwitchWishesTest, ARequestForTheSetInForceChangesNothing) {
  wish(0, kRun, "sensor");
  rounds();
  EXPECT_EQ(plan().number, 0);
  EXPECT_EQ(fake.told("switch"), "");
}

TEST_F(SwitchWishesTest, TheLastOfAllStands) {
  wish(1, kRest, "law");
  wish(0, kRun, "sensor");
  rounds();
  EXPECT_EQ(plan().number, 0);
}

TEST_F(SwitchWishesTest, WaitForTheSwitchThatIsUnderWay) {
  coordinator().ask({kRest, SwitchCause::kScript, {}}, kAnn, seconds(5), now(), [](const SwitchOutcome&) {});
  wish(0, kRest, "sensor");
  rounds();
  wish(0, kRun, "sensor");
  rounds();
  EXPECT_EQ(plan().number, 1);
  carry_out();
  rounds();
  EXPECT_EQ(plan().number, 2);
  EXPECT_TRUE(coordinator().leads_to({kRun, SwitchCause::kRequest, {}}));
}

TEST_F(SwitchWishesTest, ASuccessorFindsOpenRequestsOnly) {
  fake.kill_manager();
  wish(1, kRest, "law");
  fake.start_manager();
  ASSERT_TRUE(fake.until([this] { return plan().phase == SwitchPhase::kPrepared; }));
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', asked for by task law");
  carry_out();
  fake.kill_manager();
  fake.start_manager();
  ASSERT_TRUE(fake.until([this] { return fake.loop().is_ready(); }));
  rounds();
  EXPECT_EQ(plan().number, 1);
}

// The switch was ordered, and its manager died.
TEST_F(SwitchWishesTest, ARequestOrderedByAPredecessorIsNotOrderedAgain) {
  wish(1, kRest, "law");
  rounds();
  EXPECT_EQ(plan().number, 1);
  fake.kill_manager();
  fake.start_manager();
  ASSERT_TRUE(fake.until([this] { return fake.loop().is_ready(); }));
  rounds();
  EXPECT_EQ(plan().number, 1);
}

TEST_F(SwitchWishesTest, ReportsARefusedRequestOnce) {
  fake.rtpu(1).fail(fake.task("law"), "as told");
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().state(fake.task("law")) == State::kError; }));
  wish(0, kRun, "sensor");
  ASSERT_TRUE(fake.until([this] { return filed().size() == 1 && !fake.told("switch").empty(); }));
  rounds(20);
  ASSERT_EQ(filed().size(), 1u);
  EXPECT_NE(filed()[0].find("\"asked_by\": {\"task\": \"sensor\"}, \"end\": \"refused\""), std::string::npos)
      << filed()[0];
  EXPECT_EQ(fake.told("switch"),
            "switch to 'run', asked for by task sensor, is refused: task 'law' is in ERROR: clear it first\n");
}

TEST_F(SwitchWishesTest, ARequestOutlivesItsRtpu) {
  wish(1, kRest, "law");
  fake.kill_rtpu(1, SIGKILL);
  EXPECT_TRUE(fake.until([this] { return plan().number == 1; }));
  EXPECT_TRUE(coordinator().leads_to({kRest, SwitchCause::kRequest, {}}));
}

// The memory of an rtpu may hold any value.
TEST_F(SwitchWishesTest, SkipsRequestsThatDoNotFitTheApplication) {
  SwitchWishWords& words = fake.rtpu(1).block().head().wish;
  const auto law = static_cast<std::uint16_t>(fake.task("law").index);
  const auto sensor = static_cast<std::uint16_t>(fake.task("sensor").index);
  const SwitchWish lists{1, SwitchWish::kLists, law, SwitchCause::kRequest};
  TaskLists beyond;
  beyond.minus.add(TaskId(std::size_t{255}));
  const std::pair<SwitchWish, TaskLists> nonsense[] = {{SwitchWish::of(~std::uint64_t{0}), {}},
                                                       {{1, 2, law, SwitchCause::kRequest}, {}},
                                                       {{1, kRest, 99, SwitchCause::kRequest}, {}},
                                                       {{1, kRest, sensor, SwitchCause::kMiss}, {}},
                                                       {{1, kRest, law, SwitchCause::kScript}, {}},
                                                       {{0, kRest, law, SwitchCause::kMiss}, {}},
                                                       {lists, {}},
                                                       {lists, beyond}};
  for (const auto& [wish, named] : nonsense) {
    words.write(wish, named, now());
    rounds(2);
    EXPECT_EQ(plan().number, 0) << std::hex << wish.word();
  }
}

TEST_F(SwitchWishesTest, ARequestForTasksDependsOnTheTasksThatAreOn) {
  wish_for({.plus = {}, .minus = bits_of(std::vector{fake.task("law")})});
  rounds();
  EXPECT_EQ(plan().phase, SwitchPhase::kPrepared);
  EXPECT_EQ(coordinator().under_way(), "switch 1 to other tasks, asked for by task law");
  wish_for({.plus = {}, .minus = bits_of(std::vector{fake.task("law")})});
  rounds();
  EXPECT_EQ(plan().number, 1) << "it is under way";
}

TEST_F(SwitchWishesTest, ReportsARequestForAnIllegalSetOnce) {
  wish_for({.plus = {}, .minus = bits_of(std::vector{fake.task("sensor")})});
  rounds();
  EXPECT_EQ(plan().number, 0);
  EXPECT_EQ(fake.told("switch"),
            "switch --off sensor, asked for by task law, is refused: x would have no producer\n");
}

}  // namespace
}  // namespace chimera::manager::switch_wishes_test
