// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/scope.h"

#include <gtest/gtest.h>

#include <cmath>

#include "chimera/text/json.h"
#include "chimera/units/testing/unit_samples.h"

namespace chimera::cli {
namespace {

ScopeChannel channel(const std::string& name, const std::string& unit, bool is_scalar = true) {
  return {read_channel(name).value(), unit, is_scalar};
}

ScopeRequest request(const std::string& trigger, std::int64_t pre_ms, std::int64_t for_ms) {
  ScopeRequest asked;
  asked.channels = {channel("error", "rad"), channel("q", "rad", false)};
  if (!trigger.empty()) {
    asked.trigger = Trigger::read(trigger, our_units()).value();
    EXPECT_TRUE(asked.trigger->settle("rad", our_units()));
  }
  asked.pre = milliseconds(pre_ms);
  asked.duration = milliseconds(for_ms);
  return asked;
}

/// A message of pid with rows [at ms, sequence, error].
Json pid(std::uint64_t first, std::vector<std::array<double, 3>> rows) {
  Json json = {{"rtpu", "servo"}, {"task", "pid"}, {"variables", {"error"}}, {"first", first}, {"lost", 0}};
  json["rows"] = Json::array();
  for (const auto& [at, sequence, error] : rows)
    json["rows"].push_back({std::int64_t(at * 1e6), std::int64_t(sequence), Json::array({error})});
  return json;
}

/// A message of arm with one row, both elements `value`.
Json arm(std::uint64_t first, std::int64_t at_ms, double value) {
  return {{"rtpu", "servo"}, {"task", "arm"}, {"variables", {"q"}}, {"first", first}, {"lost", 0},
          {"rows", Json::array({Json::array({at_ms * 1'000'000, first + 1, {value, value}})})}};
}

TEST(Scope, KeepsRowsFromBeforeTheTriggerAndEndsAfterIt) {
  Scope scope(request("error > 2 mrad", 2, 1));
  scope.add(pid(0, {{1000, 1, 0}, {1001, 2, 0}, {1002, 3, 0.001}, {1003, 4, 0.002}}));
  scope.add(arm(0, 1002, 7));
  EXPECT_FALSE(scope.is_triggered());
  scope.add(pid(4, {{1004, 5, 0.003}, {1005, 6, 0.004}, {1006, 7, 0}}));
  ASSERT_TRUE(scope.is_triggered());
  EXPECT_EQ(scope.begin(), milliseconds(1004));
  EXPECT_FALSE(scope.is_complete()) << "arm has not come so far";
  scope.add(arm(1, 1005, 8));
  EXPECT_TRUE(scope.is_complete());
  EXPECT_EQ(scope.csv(),
            "t(s),error(rad),q[0](rad),q[1](rad),lost\n"
            "-0.002000000,0.001,7,7,0\n"
            "-0.001000000,0.002,7,7,0\n"
            "0.000000000,0.0030000000000000001,7,7,0\n"
            "0.001000000,0.0040000000000000001,8,8,0\n");
  EXPECT_EQ(scope.summary(), "6 rows, no gap");
}

TEST(Scope, IsNotArmedBeforeThePreTriggerIsFull) {
  Scope scope(request("error > 2 mrad", 5, 1));
  scope.add(arm(0, 1, 7));
  scope.add(pid(0, {{1, 1, 0}, {2, 2, 0.003}, {3, 3, 0}, {5.5, 4, 0.003}, {5.7, 5, 0}}));
  EXPECT_FALSE(scope.is_triggered()) << "an edge 4.5 ms after the first row has no 5 ms before it";
  EXPECT_EQ(scope.early_edges(), 2u);
  scope.add(pid(5, {{6, 6, 0.003}, {8, 7, 0}}));
  ASSERT_TRUE(scope.is_triggered());
  EXPECT_EQ(scope.begin(), milliseconds(6));
  EXPECT_EQ(scope.csv().substr(0, 80).find("-0.005000000,0,7,7"), scope.csv().find('\n') + 1) << scope.csv();
  EXPECT_NE(scope.summary().find("; 2 edges before the pre-trigger was full ignored"), std::string::npos)
      << scope.summary();
}

TEST(Scope, WaitsForEveryTaskThatIsOn) {
  Scope slow(request("error > 2 mrad", 2, 1));
  slow.add(pid(0, {{1, 1, 0}, {9, 2, 0.003}, {10, 3, 0}}));
  EXPECT_FALSE(slow.is_triggered()) << "no record of arm has arrived";
  slow.add(arm(0, 10, 7));
  slow.add(pid(3, {{11, 4, 0.003}, {11.5, 5, 0}}));
  EXPECT_FALSE(slow.is_triggered()) << "arm has records up to 1 ms only";
  slow.add(pid(5, {{12, 6, 0.003}}));
  EXPECT_TRUE(slow.is_triggered());
  Scope alone(request("error > 2 mrad", 2, 1));
  alone.add(pid(0, {{1, 1, 0}, {1002, 2, 0.003}, {1002.5, 3, 0}}));
  EXPECT_FALSE(alone.is_triggered());
  alone.add(pid(3, {{1003, 4, 0.003}}));
  EXPECT_TRUE(alone.is_triggered()) << "a second longer than the pre-trigger is enough";
}

TEST(Scope, AValueHoldsUntilTheNextOneAndToTheEdgesOfThePicture) {
  Scope scope(request("error > 2 mrad", 4, 4));
  scope.add(arm(0, 1, 7));
  scope.add(arm(1, 4, 8));
  scope.add(pid(0, {{1, 1, 0}, {6, 2, 0}, {7, 3, 0.003}, {12, 4, 0}}));
  scope.add(arm(2, 9, 9));
  scope.add(arm(3, 13, 7));
  ASSERT_TRUE(scope.is_complete());
  const draw::Plot plot = scope.plot("t", "");
  const draw::Curve& q = plot.curves[1];
  EXPECT_EQ(q.name, "q[0]");
  EXPECT_TRUE(q.is_held);
  ASSERT_EQ(q.points.size(), 4u);
  EXPECT_DOUBLE_EQ(q.points[0].at, -0.004) << "the value of 1 ms holds at the left edge, 3 ms";
  EXPECT_DOUBLE_EQ(q.points[0].value, 7);
  EXPECT_DOUBLE_EQ(q.points[1].at, -0.003);
  EXPECT_DOUBLE_EQ(q.points[2].at, 0.002);
  EXPECT_DOUBLE_EQ(q.points[3].at, 0.004) << "and the last one at the right edge";
  EXPECT_DOUBLE_EQ(q.points[3].value, 9);
  EXPECT_EQ(scope.rows(), 4u) << "a value that only holds is no row of the window";
}

TEST(Scope, AValueFromBeforeTheWindowHoldsIntoIt) {
  Scope scope(request("error > 2 mrad", 1, 1));
  scope.add(arm(0, 1000, 7));
  scope.add(arm(1, 1001, 9));
  scope.add(pid(0, {{1000, 1, 0}, {1005, 2, 0.003}, {1006, 3, 0.004}}));
  EXPECT_EQ(scope.csv(), "t(s),error(rad),q[0](rad),q[1](rad),lost\n"
                         "0.000000000,0.0030000000000000001,9,9,0\n"
                         "0.001000000,0.0040000000000000001,9,9,0\n");
  EXPECT_EQ(scope.rows(), 2u);
}

/// A request for `rows` rows of one channel, from the first one on.
ScopeRequest of_error(std::size_t rows) {
  ScopeRequest asked = request("", 0, rows);
  asked.channels.pop_back();
  return asked;
}

TEST(Scope, WithoutATriggerItBeginsWithTheFirstRow) {
  Scope scope(of_error(2));
  scope.add(pid(0, {{5, 1, 1}, {6, 2, 2}}));
  EXPECT_TRUE(scope.is_triggered());
  EXPECT_FALSE(scope.is_complete());
  scope.add(pid(2, {{7, 3, 3}, {8, 4, 4}}));
  EXPECT_TRUE(scope.is_complete());
  EXPECT_EQ(scope.rows(), 3u);
}

TEST(Scope, RowsThatWereLostAreCountedAndShown) {
  Scope scope(of_error(10));
  scope.add(pid(0, {{1, 1, 1}, {2, 2, 2}}));
  scope.add(pid(5, {{6, 6, 3}, {7, 7, 4}, {9, 9, 5}}));  // three rows of the tap, then one publication
  EXPECT_EQ(scope.summary(), "5 rows; 2 gaps, 4 rows lost");
  EXPECT_EQ(scope.csv(),
            "t(s),error(rad),lost\n0.000000000,1,0\n0.001000000,2,0\n0.005000000,3,3\n0.006000000,4,0\n"
            "0.008000000,5,1\n");
  const draw::Plot plot = scope.plot("t", "");
  ASSERT_EQ(plot.gaps.size(), 2u);
  EXPECT_DOUBLE_EQ(plot.gaps[0].from, 0.001);
  EXPECT_DOUBLE_EQ(plot.gaps[0].to, 0.005);
  EXPECT_EQ(plot.gaps[0].text, "3 rows of pid lost");
  EXPECT_EQ(plot.gaps[1].text, "1 row of pid lost");
  ASSERT_EQ(plot.curves.size(), 1u);
  ASSERT_EQ(plot.curves[0].points.size(), 7u);
  EXPECT_TRUE(std::isnan(plot.curves[0].points[2].value)) << "the line is broken there";
}

TEST(Scope, ATaskThatWasMadeAnewBreaksTheLineButLosesNothing) {
  Scope scope(of_error(10));
  scope.add(pid(0, {{1, 100, 1}, {2, 1, 2}}));
  EXPECT_EQ(scope.lost_rows(), 0u);
  EXPECT_EQ(scope.plot("t", "").curves[0].points.size(), 3u);
}

TEST(Scope, ThePictureHasNoCurveOfATaskThatHasNotPublished) {
  Json spare = pid(0, {{1, 1, 0}});
  spare["task"] = "spare";
  spare["rows"][0][2] = Json::array({Json()});
  for (const bool is_first : {true, false}) {
    Scope scope(request("error > 2 mrad", 0, 4));
    if (is_first) scope.add(spare);
    scope.add(pid(0, {{1, 1, 0}, {6, 2, 0.003}, {7, 3, 0.003}}));
    if (!is_first) scope.add(spare);
    const draw::Plot plot = scope.plot("t", "");
    ASSERT_EQ(plot.curves.size(), 1u);
    EXPECT_DOUBLE_EQ(plot.curves[0].points.back().value, 0.003);
  }
}

TEST(Scope, ThePictureHasTheTriggerAndItsLevel) {
  ScopeRequest asked = request("error > 2 mrad", 1, 5);
  asked.channels.pop_back();
  Scope scope(asked);
  scope.add(pid(0, {{1, 1, 0}, {2, 2, 0.003}}));
  const draw::Plot plot = scope.plot("arm", "note");
  EXPECT_EQ(plot.mark, 0);
  EXPECT_DOUBLE_EQ(plot.level, 0.002);
  EXPECT_EQ(plot.level_unit, "rad");
  EXPECT_DOUBLE_EQ(plot.curves[0].points[0].at, -0.001);
}

TEST(Scope, MemoryIsBoundedWhileItWaits) {
  ScopeRequest asked = request("error > 2 mrad", 3, 1);
  asked.channels.pop_back();
  Scope scope(asked);
  for (int i = 0; i < 1000; ++i) scope.add(pid(std::uint64_t(i), {{i * 1.0, i + 1.0, 0}}));
  scope.add(pid(1000, {{1000, 1001, 1}}));
  EXPECT_EQ(scope.rows(), 4u);
}

/// A notification of the operator variable q: its value since `published`, at `now`.
Json given(std::int64_t now_ms, std::int64_t published_ms, double value) {
  return {{"at_ns", now_ms * 1'000'000},
          {"values", {{"q", {{"published_ns", published_ms * 1'000'000}, {"value", Json::array({value, value})}}}}}};
}

TEST(Scope, AnOperatorVariableIsRecordedAndTriggers) {
  ScopeRequest asked = request("", 0, 4);
  asked.trigger = Trigger::read("q[0] > 15 rad", our_units()).value();
  ASSERT_TRUE(asked.trigger->settle("rad", our_units()));
  Scope scope(asked);
  scope.add_values(given(1000, 3, 10));
  scope.add(pid(0, {{1001, 1, 0.5}}));
  scope.add_values(given(1002, 3, 10));
  EXPECT_FALSE(scope.is_triggered());
  scope.add_values(given(1004, 1003, 20));
  ASSERT_TRUE(scope.is_triggered());
  EXPECT_EQ(scope.begin(), milliseconds(1003)) << "the time of `set`, not of its notification";
  scope.add(pid(1, {{1005, 2, 0.25}, {1008, 3, 0}}));
  EXPECT_FALSE(scope.is_complete()) << "q may still change";
  scope.add_values(given(1008, 1003, 20));
  EXPECT_TRUE(scope.is_complete());
  EXPECT_EQ(scope.csv(), "t(s),error(rad),q[0](rad),q[1](rad),lost\n"
                         "0.000000000,0.5,20,20,0\n"
                         "0.002000000,0.25,20,20,0\n");
}

TEST(Scope, OddMessagesArePassedOver) {
  Scope scope(request("", 0, 1));
  for (const char* odd : {"null", "{}", R"({"rows": 3})", R"({"rows": [1, [], ["a", 1], [1]]})",
                          R"({"variables": ["q"], "rows": [[1, 2]]})", R"({"variables": ["x"], "rows": [[1, 2, 3]]})"})
    scope.add(Json::parse(odd));
  EXPECT_EQ(scope.lost_rows(), 0u);
  EXPECT_EQ(scope.csv().substr(0, 10), "t(s),lost\n");
}

}  // namespace
}  // namespace chimera::cli
