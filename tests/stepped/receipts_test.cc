// SPDX-License-Identifier: Apache-2.0
// Each request for a switch has one receipt, whatever its end, with a number and no gap.
#include <gtest/gtest.h>

#include <random>

#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager::receipts_test {
namespace {

// `quick` waits while the operator variable `hold` is above 0.
const std::string kReceipts = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  slow: {component: gain, rtpu: first, rate: 1 kHz, alias: {x: given, y: wanted}, constants: {k: 2}}
  fast:
    {component: gain, rtpu: second, rate: 1 kHz, alias: {x: given, y: wanted}, constants: {k: 4}, max_step: {y: 3 m/s}}
  steep:
    {component: gain, rtpu: second, rate: 1 kHz, alias: {x: given, y: wanted}, constants: {k: 40}, max_step: {y: 3 m/s}}
  held: {component: gain, rtpu: first, rate: 1 kHz, alias: {x: hold, y: holds}, constants: {k: 1}}
operator: {given: 1 m/s, hold: 0}
configurations:
  gentle: [slow, held]
  quick: {tasks: [fast, held], safe_when: 'holds < 1'}
  wild: [steep, held]
start: gentle
)";
const std::string kGentle = "slow held ", kQuick = "fast held ";

Json to(const char* configuration) { return {{"configuration", configuration}}; }

TEST(SteppedReceipts, DoneAbortedAndRefusedSwitchesAreFiledAlike) {
  SteppedSubsystem system(kReceipts);
  ASSERT_TRUE(system.until_started());
  const Json done = system.result("switch", to("quick"));
  const Json aborted = system.result("switch", to("wild"));
  const Json back = system.result("switch", to("gentle"));
  (void)system.result("signal", {{"signal", "kill"}, {"tasks", Json::array({"fast"})}});
  EXPECT_FALSE(system.call("switch", to("quick")).is_good());
  EXPECT_EQ(system.result("switch", to("gentle"))["end"], "nothing-to-do");
  EXPECT_EQ(system.ends(), "quick done\nwild aborted\ngentle done\nquick refused\n");
  const Json filed = system.receipts();
  ASSERT_EQ(filed.size(), 4u);
  EXPECT_EQ(filed[std::size_t{0}], done) << "the filed receipt equals the answer";
  EXPECT_EQ(filed[std::size_t{1}], aborted);
  EXPECT_EQ(filed[std::size_t{2}], back);
  EXPECT_EQ(filed[std::size_t{3}]["why"], "task 'fast' is not there: spawn it first");
  int number = 0;
  for (const Json& receipt : filed) {
    EXPECT_EQ(receipt["number"], ++number);
    EXPECT_EQ(receipt["asked_by"]["role"], "configure");
  }
  EXPECT_EQ(done["from"], "gentle");
  EXPECT_EQ(aborted["from"], "quick");
  EXPECT_EQ(done["variables"][std::size_t{0}]["unit"], "m/s");
  EXPECT_EQ(system.result("receipts", {{"last", 2}})["receipts"].size(), 2u);
}

TEST(SteppedEvents, EachEventOfAPersonNamesThePerson) {
  SteppedSubsystem system(kReceipts);
  ASSERT_TRUE(system.until_started());
  const std::uint64_t last = system.manager().state().log.last();
  system.set("given", 0.5);
  for (const char* const word : {"off", "reinit", "on", "off", "kill", "spawn", "clear", "on"})
    (void)system.call("signal", {{"signal", word}, {"tasks", Json::array({"held"})}});
  (void)system.result("flag", {{"up", true}});
  (void)system.result("flag", {{"up", false}});
  (void)system.result("switch", to("quick"));
  (void)system.result("switch", to("wild"));
  (void)system.call("drill");
  (void)system.call("end");
  std::map<std::string, int> counts;
  const Json told = system.result("events", {{"since", last + 1}});
  for (const Json& event : told["events"]) {
    const std::string kind = event["kind"].as_string();
    const bool is_of_rtpu = kind == "flag" && !text_at(event, "text").starts_with("the operator");
    if (kind == "state" || is_of_rtpu) continue;
    EXPECT_TRUE(text_at(event, "by").starts_with("configure:")) << event;
    ++counts[kind];
  }
  EXPECT_EQ(counts["set"], 1);
  EXPECT_EQ(counts["flag"], 2);
  EXPECT_EQ(counts["command"], 9) << told;
  EXPECT_EQ(counts["switch"], 4) << told;
  EXPECT_EQ(counts["drill"], 2) << told;
}

TEST(SteppedReceipts, ASecondRequestIsRefusedByNameAndTheFirstOneCanBeCancelled) {
  SteppedSubsystem system(kReceipts);
  ASSERT_TRUE(system.until_started());
  EXPECT_EQ(system.call("cancel").detail("kind"), "no-switch");
  system.set("hold", 1);
  ASSERT_TRUE(system.until([&] { return system.value("holds") == 1; }));
  const PendingAnswer first = system.ask("switch", to("quick"));
  const control::RpcResponse second = system.call("switch", to("wild"));
  EXPECT_EQ(second.detail("kind"), "under-way");
  EXPECT_NE(second.message.find("switch to 'wild' is refused: switch 1 to 'quick', asked for by configure:"),
            std::string::npos)
      << second.message;
  EXPECT_EQ(system.result("plan", to("wild"))["reason"], "under-way");
  const Json status = system.result("status");
  EXPECT_EQ(status["switch"]["to"], "quick");
  EXPECT_EQ(status["switch"]["progress"], "arming");
  EXPECT_GT(status["switch"]["deadline_ns"].as_int64(), status["now_ns"].as_int64());
  const Json cancelled = system.result("cancel");
  ASSERT_TRUE(first->has_value());
  EXPECT_EQ(SteppedSubsystem::result_of(**first), cancelled);
  EXPECT_EQ(text_at(cancelled, "why").find("cancelled by configure:"), 0u) << cancelled;
  EXPECT_EQ(system.on(), kGentle);
  EXPECT_EQ(system.result("status")["switch"], nullptr);
  system.set("hold", 0);
  EXPECT_EQ(system.result("switch", to("quick"))["end"], "done");
  EXPECT_EQ(system.on(), kQuick);
}

TEST(SteppedReceipts, ADryRunForeseesTheSwitchAndChangesNothing) {
  SteppedSubsystem system(kReceipts);
  ASSERT_TRUE(system.until_started());
  const Json plan = system.result("plan", to("quick"));
  EXPECT_EQ(plan["from"], "gentle");
  EXPECT_EQ(plan["to"], "quick");
  EXPECT_EQ(plan["end"], "possible");
  EXPECT_EQ(plan["way"], "fast");
  EXPECT_EQ(plan["arrives"], Json::array({"fast"}));
  EXPECT_EQ(plan["leaves"], Json::array({"slow"}));
  EXPECT_EQ(plan["stays"], Json::array({"held"}));
  EXPECT_EQ(plan["variables"], Json::array({Json({{"variable", "wanted"}, {"from", "slow"}, {"to", "fast"}})}));
  EXPECT_EQ(system.result("plan", to("gentle"))["end"], "nothing-to-do");
  (void)system.result("signal", {{"signal", "kill"}, {"tasks", Json::array({"fast"})}});
  const Json refused = system.result("plan", to("quick"));
  EXPECT_EQ(refused["end"], "refused");
  EXPECT_EQ(refused["reason"], "not-created");
  EXPECT_EQ(refused["remedy"], "`chimera spawn fast`");
  EXPECT_EQ(system.on(), kGentle);
  EXPECT_EQ(system.receipts().size(), 0u);
}

/// A client that asks for switches at random instants.
struct Operator {
  std::string target;
  Nanoseconds next = now(), asked{};
  PendingAnswer answer;
};
struct Told {
  std::string target;
  Nanoseconds asked, answered;
  control::RpcResponse answer;
};

std::vector<Told> random_requests(SteppedSubsystem& system, std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  const char* const targets[] = {"gentle", "quick", "wild"};
  std::vector<Told> told;
  for (std::vector<Operator> operators(4); told.size() < n; system.run(microseconds(100)))
    for (Operator& one : operators) {
      if (one.answer && one.answer->has_value()) {
        told.push_back({one.target, one.asked, now(), **one.answer});
        one.answer = nullptr;
        one.next = now() + microseconds(random() % 20'000);
      } else if (!one.answer && now() >= one.next) {
        one.target = targets[random() % 3];
        one.asked = now();
        one.answer = system.ask("switch", to(one.target.c_str()));
      }
    }
  return told;
}

/// Since when which configuration is in force, by the receipts; each switch begins in the one before it.
std::vector<std::pair<Nanoseconds, std::string>> history_of(const Json& receipts) {
  std::vector<std::pair<Nanoseconds, std::string>> history{{Nanoseconds{}, "gentle"}};
  std::set<std::int64_t> numbers;
  for (const Json& receipt : receipts) {
    EXPECT_TRUE(numbers.insert(receipt["number"].as_int64()).second) << receipt;
    if (receipt["end"] != "done") continue;
    EXPECT_EQ(receipt["from"], history.back().second) << receipt;
    const Nanoseconds at{whole_at(receipt, "origin_ns") + whole_at(receipt, "at_ns")};
    history.push_back({at, text_at(receipt, "to")});
  }
  EXPECT_EQ(numbers.size(), receipts.size());
  EXPECT_EQ(*numbers.rbegin(), static_cast<std::int64_t>(receipts.size())) << "no number is missing";
  return history;
}

TEST(SteppedReceipts, ReceiptsExplainEachAnswerToFourOperators) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  SteppedSubsystem system(kReceipts);
  ASSERT_TRUE(system.until_started());
  const std::vector<Told> told = random_requests(system, 100, seed);
  ASSERT_TRUE(system.until([&] { return system.result("plan", to("gentle"))["reason"] != "under-way"; }));
  const Json receipts = system.result("receipts", {{"last", 200}})["receipts"];
  const auto history = history_of(receipts);
  EXPECT_EQ(system.on(), history.back().second == "quick" ? kQuick : kGentle);
  for (const Told& one : told) {
    if (!one.answer.is_good()) {
      EXPECT_EQ(one.answer.detail("kind"), "under-way") << one.answer.message;
      continue;
    }
    const Json answer = SteppedSubsystem::result_of(one.answer);
    EXPECT_EQ(answer["to"], one.target);
    bool is_explained = false;
    if (answer["end"] == "nothing-to-do") {
      for (std::size_t i = 0; i < history.size(); ++i)
        is_explained = is_explained || (history[i].second == one.target && history[i].first <= one.answered &&
                                        (i + 1 == history.size() || one.asked <= history[i + 1].first));
    } else {
      for (const Json& receipt : receipts) is_explained = is_explained || receipt == answer;
      if (answer["end"] != "done") {
        EXPECT_EQ(answer["reason"], "step-too-large") << answer;
        EXPECT_EQ(one.target, "wild");
      }
    }
    EXPECT_TRUE(is_explained) << answer;
  }
}

}  // namespace
}  // namespace chimera::manager::receipts_test
