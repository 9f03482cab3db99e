// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/answer_text.h"
#include "chimera/text/json.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

TEST(AnswerText, JsonIsWrittenForANameOfAnyBytes) {
  EXPECT_EQ(json_line({{"file", "a\xff"}}), "{\"file\":\"a\xef\xbf\xbd\"}\n");
}

TEST(AnswerText, ReadingsSayTheirProducerAndTheirAge) {
  EXPECT_EQ(readings_text(Json::parse(R"({"values": {
              "kp": {"value": [100, 90], "text": "[100 90] N.m/rad", "producer": "operator", "state": "ON",
                     "sequence": 3, "age_ns": 1200000000, "valid": true},
              "q": {"value": null, "text": "never written", "producer": "arm", "state": "OFF", "sequence": 0,
                    "age_ns": 77, "valid": false},
              "x": {"value": null, "text": "never written", "producer": "", "state": "NOT-CREATED"}}})")),
            "kp = [100 90] N.m/rad  (operator, 1.20 s ago)\n"
            "q = never written  (arm is OFF)\n"
            "x = never written  (no producer is NOT-CREATED)\n");
}

TEST(AnswerText, SignalsPrintTheStateOfEachTask) {
  EXPECT_EQ(signal_text(Json::parse(R"({"tasks": [{"task": "pid", "before": "ON", "after": "OFF"},
                                                  {"task": "arm", "before": "OFF", "after": "OFF"}]})")),
            "pid: ON -> OFF\narm: OFF\n");
  EXPECT_EQ(signal_text(Json::parse(R"({"tasks": [{"task": "arm", "before": "ON", "after": "ON", "already": true}]})")),
            "arm: ON already\n");
}

TEST(AnswerText, TheFlagNamesTheProcessesThatKeepItUp) {
  EXPECT_EQ(flag_text(Json::parse(R"({"up": true, "by": ["servo", "operator"]})")), "flag UP by servo, operator\n");
  EXPECT_EQ(flag_text(Json::parse(R"({"up": false, "by": []})")), "flag down\n");
}

TEST(AnswerText, ADrillPrintsWhetherEachTaskIsSafe) {
  EXPECT_EQ(drill_text(Json::parse(R"({"safe": false, "flag_ns": 31000000, "tasks": [
              {"task": "arm", "verdict": "safe", "after_ns": 28400000},
              {"task": "winch", "verdict": "cannot-tell", "after_ns": null},
              {"task": "lift", "verdict": "waiting", "after_ns": null},
              {"task": "door", "verdict": "left", "after_ns": null}]})")),
            "arm: safe 28.4 ms after the flag\n"
            "winch: cannot tell: its component has no safe_state output\n"
            "lift: not safe\n"
            "door: left service before it was safe\n"
            "flag up for 31 ms\n");
  EXPECT_EQ(drill_text(Json::parse(R"({"flag_ns": 1000000, "tasks": [{"task": "a", "verdict": "waiting"}],
              "killed": {"rtpu": "servo", "is_told": true, "written": 1, "lost": 1, "after_ns": 400000}})")),
            "a: not safe\nservo: killed, 1 of 2 safe frames written 400 us after the kill\nflag up for 1 ms\n");
  EXPECT_EQ(drill_text(Json::parse(R"({"flag_ns": 1000000, "tasks": [{"task": "a", "verdict": "waiting"}],
              "killed": {"rtpu": "servo", "is_told": true, "written": 0, "lost": 0, "after_ns": null}})")),
            "a: not safe\nservo: killed, and it had no safe frame\nflag up for 1 ms\n");
  EXPECT_EQ(drill_text(Json::parse(R"({"safe": false, "flag_ns": 0, "tasks": []})")),
            "no task that is ON has hardware that could move\nflag up for 0 ns\n");
}

TEST(AnswerText, SaveSpeaksTheWordsOfADescription) {
  EXPECT_EQ(save_text(Json::parse(R"({"operator": {"kp": "[100 N.m/rad, 90 N.m/rad]", "name": "\"x\""}})")),
            "operator:\n  kp: [100 N.m/rad, 90 N.m/rad]\n  name: \"x\"\n");
  EXPECT_EQ(save_text(Json::parse(R"({"operator": {}})")), "no operator variables\n");
}

Json link(int depth, const std::string& variable, const std::string& verdict) {
  return {{"depth", depth}, {"variable", variable}, {"producer", "t_" + variable}, {"component", "c"},
          {"rtpu", "servo"}, {"state", "ON"}, {"period_ns", 1'000'000}, {"published_ns", 5}, {"age_ns", 412'000},
          {"valid", true}, {"value", "1 rad"}, {"verdict", verdict}, {"inputs", {"q", "q_ref"}}};
}

TEST(AnswerText, WhyPrintsProducerAgeInputsAndTheFirstTrouble) {
  Json answer = {{"variable", "tau"},
                 {"chain", {link(0, "tau", "ok"), link(1, "q", "ok"), link(2, "q_ref", "stale")}},
                 {"verdict", "tau depends on q_ref: stale"}};
  answer["chain"][2]["late"] = "a loop is cut here";
  EXPECT_EQ(why_text(answer, 24),
            "tau = 1 rad\n"
            "  produced by  t_tau (c) on servo, ON\n"
            "  published    412 us ago, every 1.00 ms\n"
            "  from         q, q_ref\n"
            "\n"
            "ancestor  verdict  producer     state     age   period  late  value\n"
            " q_ref    stale    t_q_ref (c)  ON     412 us  1.00 ms     1  1 rad\n"
            "q         ok       t_q (c)      ON     412 us  1.00 ms     0  1 rad\n"
            "\n"
            "tau depends on q_ref: stale\n");
}

TEST(AnswerText, WhyStaysOnOneScreen) {
  Json chain = Json::array();
  for (int i = 0; i < 100; ++i) chain.push_back(link(i, "v" + std::to_string(i), i == 99 ? "stale" : "ok"));
  const std::string text = why_text({{"chain", chain}, {"verdict", "v0 depends on v99"}}, 24);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 24) << text;
  EXPECT_NE(text.find("v99  stale"), std::string::npos) << text;
  EXPECT_NE(text.find("... and 84 more\n"), std::string::npos) << text;
}

TEST(AnswerText, WhyPrintsFailuresOfTimeAndFitsOneScreen) {
  Json chain = Json::array();
  for (int i = 0; i < 100; ++i) chain.push_back(link(i, "v" + std::to_string(i), "ok"));
  chain[0]["timing"] = "3 missed, 1 demoted";
  const std::string text = why_text({{"chain", chain}, {"verdict", "v0 is good"}}, 24);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 24) << text;
  EXPECT_NE(text.find("\n  in time      3 missed, 1 demoted\n"), std::string::npos) << text;
}

TEST(AnswerText, DryRunNamesAnOffThatFitsNoGap) {
  const Json answer = {{"from", "both"}, {"to", "light"}, {"end", "possible"}, {"way", "fast"},
                       {"expected_ns", 1000000}, {"late_off", {{"task", "old"}, {"needs_ns", 880000}}},
                       {"leaves", {"old"}}};
  EXPECT_EQ(plan_text(answer),
            "switch from 'both' to 'light' would begin, the fast way; it is expected to take 1.00 ms\n"
            "  leaves: old\n"
            "  off of old is taken to need 880 us; no gap is as long, so it runs 100 ms after the change and may delay "
            "cycles\n");
}

TEST(AnswerText, WhyOfAnOperatorVariable) {
  const Json answer = {{"chain", {{{"variable", "kp"}, {"producer", "operator"}, {"state", "ON"}, {"valid", true},
                                   {"value", "3"}, {"published_ns", 0}, {"verdict", "ok"}}}},
                       {"verdict", "kp is good: set by the operator"}};
  EXPECT_EQ(why_text(answer, 24),
            "kp = 3\n  produced by  operator\n  published    never\n  from         no inputs\n\n"
            "kp is good: set by the operator\n");
}

TEST(AnswerText, ARingNamesEachTaskAsOftenAsItIsRung) {
  EXPECT_EQ(ring_text({{"tasks", {"lamp", "lamp"}}}), "lamp: rung\nlamp: rung\n");
}

TEST(AnswerText, RefusalsSayEachThingOnce) {
  EXPECT_EQ(refusal_text("no task 'pdi'", {{"where", "pdi"}, {"nearest", "pid"}}),
            "no task 'pdi'; did you mean 'pid'?");
  EXPECT_EQ(refusal_text("not legal in ON", {{"where", "pid"}, {"remedy", "off first"}}),
            "pid: not legal in ON; off first");
  EXPECT_EQ(refusal_text("ending", Json()), "ending");
  EXPECT_EQ(refusal_text("no task 'pdi'; did you mean 'pid'?", {{"nearest", "pid"}}),
            "no task 'pdi'; did you mean 'pid'?");
}

}  // namespace
}  // namespace chimera::cli
