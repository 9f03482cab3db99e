// SPDX-License-Identifier: Apache-2.0
// Requests and reactions of tasks: from the component in an rtpu over the manager to the switch and its receipt.
#include <gtest/gtest.h>

#include "chimera/manager/testing/stepped_subsystem.h"

namespace chimera::manager::requests_stepped_test {

// `asker` asks for what the operator variable `wish` says: 1 for `first`, 2 for `second`.
const std::string kTasksAsk = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  asker: {component: t_asker, rtpu: second, rate: 100 Hz, constants: {first: low, second: high}}
  one: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: given, y: level}, constants: {k: 1}}
  two: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: given, y: level}, constants: {k: 1}}
  reader: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: level, y: seen}, constants: {k: 1}}
operator: {wish: 0, given: 5}
configurations:
  low: [steady, asker, one, reader]
  high: {tasks: [steady, asker, two, reader], safe_when: 'seen < 8'}
start: low
)";
const std::string kLow = "steady asker one reader ", kHigh = "steady asker two reader ";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, text.npos) << what;
  return at == text.npos ? text : text.replace(at, what.size(), with);
}

TEST(SteppedRequests, CarryOutWhatATaskAsksForAndNameTheTask) {
  for (const std::string& lists : {std::string("{first: low, second: high}"),
                                   std::string("{first: --on one, second: --on two --off one}")}) {
    SteppedSubsystem system(replaced(kTasksAsk, "{first: low, second: high}", lists));
    ASSERT_TRUE(system.until_started());
    system.set("wish", 2);
    ASSERT_TRUE(system.until([&] { return system.on() == kHigh; })) << system.on() << system.events("switch");
    system.set("wish", 1);
    ASSERT_TRUE(system.until([&] { return system.on() == kLow; })) << system.on() << system.events("switch");
    system.run(milliseconds(300));  // thirty cycles that ask for what is in force
    EXPECT_EQ(system.ends(), "high done\nlow done\n");
    for (const Json& receipt : system.receipts()) EXPECT_EQ(receipt["asked_by"], Json({{"task", "asker"}}));
    EXPECT_EQ(system.value("refused"), 0);
  }
}

TEST(SteppedRequests, RefuseTasksThatAreNoLegalSetByName) {
  SteppedSubsystem system(replaced(kTasksAsk, "{first: low, second: high}", "{first: --on one, second: --off one two}"));
  ASSERT_TRUE(system.until_started());
  system.set("wish", 2);
  ASSERT_TRUE(system.until([&] { return !system.events("switch").empty(); }));
  const std::string refusal =
      "switch --off one two, asked for by task asker, is refused: level would have no producer\n";
  EXPECT_EQ(system.events("switch"), refusal);
  system.run(milliseconds(250));  // the refused request is made again ten times a second
  EXPECT_EQ(system.events("switch"), refusal + refusal + refusal);
  system.set("wish", 1);  // in force
  system.run(milliseconds(500));
  EXPECT_EQ(system.events("switch"), refusal + refusal + refusal);
  EXPECT_EQ(system.on(), kLow);
  EXPECT_EQ(system.receipts(), Json::array());
}

}  // namespace chimera::manager::requests_stepped_test
