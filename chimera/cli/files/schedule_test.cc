// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/files/schedule.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/cli/files/testing/test_place.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/edit_json.h"
#include "chimera/text/json.h"
#include "chimera/text/time_text.h"

namespace chimera::cli {
namespace {

const std::string kTwo =
    "subsystem: two\n"
    "rtpus: {fast: {cpu: 0, policy: rm}, spare: {cpu: 1}}\n"
    "tasks:\n"
    "  a: {component: t_counter, rate: 100 Hz, budget: 2 ms, rtpu: fast, alias: {count: a_count}}\n"
    "  b: {component: t_counter, rate: 20 Hz, budget: 9 ms, rtpu: fast, alias: {count: b_count, dt: b_dt, now: b_now,\n"
    "      deadline: b_deadline, cycles: b_cycles, dropped: b_dropped, illegal: b_illegal}}\n";

CommandResult scheduled(const std::string& text, const std::string& dispatch, const std::string& profile = "") {
  const TestFile file(text);
  return schedule({file.path(), profile, "", dispatch, false}, test_place());
}

TEST(Schedule, SaysThatAllTasksFit) {
  const CommandResult output = scheduled(kTwo, "preemptive");
  EXPECT_EQ(output.code, kOk) << output.err;
  EXPECT_EQ(output.out,
            "two: configuration 'all' (start), preemptive\n"
            "CPU 0: rtpu fast, rm; load 0.380 of at most 0.93; rate monotonic bound 0.828, "
            "product of (1 + load) 1.416, enough up to 2\n"
            "  task  rtpu  crit.  time         period  deadline  response  blocked  copies  deadline is\n"
            "  a     fast  low    2 ms budget  10 ms   10 ms     2 ms      -        -       kept\n"
            "  b     fast  low    9 ms budget  50 ms   50 ms     13 ms     -        -       kept\n"
            "  fits: every task keeps its deadline, also with all times 2.44 times as long as stated\n"
            "  worst window, a letter for 500 us:\n"
            "       0  AAAABBBBBBBBBBBBBBBBAAAABB\n"
            "          A = a\n"
            "          B = b\n"
            "          . = idle\n");
}

TEST(Schedule, NamesTheTaskThatMissesInAnExecutiveAndTheRemedies) {
  const CommandResult output = scheduled(kTwo, "executive");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_NE(output.out.find("  a     fast  low    2 ms budget  10 ms   10 ms     at most 11 ms  9 ms     -       "
                            "NOT KEPT\n"),
            std::string::npos)
      << output.out;
  EXPECT_NE(output.out.find("  does not fit\n  guaranteed: b\n  not guaranteed: a\n  first to give way: b\n"
                            "  would fit: rtpu 'fast' with executor: preemptive\n"
                            "         or: task 'a' at rate: 90.9 Hz\n         or: task 'b' on rtpu: spare\n"
                            "         or: all times 0.909 times as long as stated\n"),
            std::string::npos)
      << output.out;
}

TEST(Schedule, AnOverloadedSetIsAnalysedWithARemedyThatFits) {
  std::string text = kTwo;
  text.replace(text.find("budget: 9 ms"), 12, "budget: 45 ms");
  const CommandResult output = scheduled(text, "preemptive");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_NE(output.err.find("warning: the budgets of configuration 'all' take 1.100 of CPU 0; expected at most 0.93 "
                            "[utilisation]\n  task 'b' takes most: it would fit with budget: 36.5 ms or rate: "
                            "16.2 Hz\n"),
            std::string::npos)
      << output.err;
  EXPECT_NE(output.out.find("  does not fit\n  guaranteed: a\n  not guaranteed: b\n"), std::string::npos)
      << output.out;
  EXPECT_NE(output.out.find("  would fit: task 'b' at rate: 16.2 Hz\n"), std::string::npos) << output.out;
}

struct Line {
  std::string name, rtpu, criticality, rate;
  int budget_us = 0;
};

constexpr const char* kOutputs[] = {"count", "dt", "now", "deadline", "cycles", "dropped", "illegal"};

std::string description(const std::string& rtpus, const std::vector<Line>& lines) {
  std::string text = "subsystem: s\nrtpus: {" + rtpus + "}\ntasks:\n";
  for (const Line& line : lines) {
    text += "  " + line.name + ": {component: t_counter, rtpu: " + line.rtpu + ", criticality: " + line.criticality +
            ", rate: " + line.rate + " Hz, budget: " + std::to_string(line.budget_us) + " us, alias: {";
    for (const char* output : kOutputs) text += std::string(output) + ": " + line.name + output + ", ";
    text += "}}\n";
  }
  return text;
}

Json analysed(const std::string& text) {
  const TestFile file(text);
  return Json::parse(schedule({file.path(), "", "", "", true}, test_place()).out);
}

TEST(Schedule, AStandbyIsAnalysedInThePlaceOfItsPrimaryAndAHotOneBesideItToo) {
  const auto loads = [](const char* hot) {
    const std::string text =
        "subsystem: pair\n"
        "rtpus: {fast: {cpu: 0}, spare: {cpu: 1}}\n"
        "tasks:\n"
        "  a: {component: t_counter, rate: 100 Hz, budget: 2 ms, rtpu: fast}\n"
        "  b: {component: t_counter, rate: 100 Hz, budget: 3 ms, rtpu: spare, standby_for: {task: a, hot: " +
        std::string(hot) + "}}\nconfigurations: {run: [a]}\n";
    std::string all;
    const Json report = analysed(text);
    for (const Json& set : report["sets"]) {
      all += set["name"].as_string() + ":";
      for (const Json& cpu : set["cpus"]) all += " " + cpu["cpu"].dump() + " " + cpu["utilisation"].dump();
      all += "; ";
    }
    return all;
  };
  EXPECT_EQ(loads("false"), "run: 0 0.2; run with b for a: 1 0.3; ");
  EXPECT_EQ(loads("true"), "run: 0 0.2 1 0.3; run with b for a: 1 0.3; ");
}

/// CPU 0 as the analysis sees it after the acts of the remedy.
Json changed(const std::string& text, const Json& remedy) {
  const auto acts = edit_acts(remedy["acts"]);
  const auto edited = edit_text(text, acts ? *acts : std::vector<EditAct>());
  EXPECT_TRUE(acts && edited) << remedy;
  const Json said = analysed(edited ? *edited : "");
  return said.contains("sets") ? said["sets"][0]["cpus"][0] : said;
}

/// The key that the remedy changes.
std::string kind_of(const Json& remedy) {
  for (const char* kind : {"executor", "rate_hz", "criticality"})
    if (remedy.contains(kind)) return text_at(remedy, kind) == "low" ? "lower" : kind;
  return remedy["rtpu"].is_null() ? "new rtpu" : "rtpu";
}

std::vector<Line> random_lines(std::mt19937& random) {
  constexpr int kPeriodsMs[] = {2, 4, 5, 10, 20};
  constexpr const char* kCriticalities[] = {"low", "medium", "high"};
  std::vector<Line> lines;
  for (int i = 0; i < 4; ++i) {
    const int ms = kPeriodsMs[random() % 5];
    lines.push_back({"t" + std::to_string(i), i == 3 ? "b" : "a", kCriticalities[random() % 3],
                     std::to_string(1000 / ms), ms * (150 + static_cast<int>(random() % 200))});
  }
  return lines;
}

// Applies each remedy: the changed description is analysed again and must fit.
TEST(Schedule, ItsAdviceIsTrue) {
  std::mt19937 random(3);
  std::map<std::string, int> tried;
  for (int run = 0; run < 8; ++run) {
    const std::vector<Line> lines = random_lines(random);
    const std::string policy = run % 4 == 0 ? "rm" : run % 4 == 1 ? "edf" : "muf";
    const std::string executor = run % 8 < 4 ? "preemptive" : "executive";
    const std::string rtpus = "a: {cpu: 0, policy: " + policy + ", executor: " + executor + "}, b: {cpu: 1}";
    const std::string text = description(rtpus, lines);
    const Json said = analysed(text);
    ASSERT_TRUE(said.contains("sets")) << said;
    for (const Json& remedy : said["sets"][0]["cpus"][0]["remedies"]) {
      const Json cpu = changed(text, remedy);
      const bool is_lower = kind_of(remedy) == "lower";
      ++tried[kind_of(remedy)];
      ASSERT_TRUE(cpu.contains("fits")) << remedy << cpu;
      EXPECT_TRUE(is_lower || cpu["fits"].as_bool()) << remedy << description(rtpus, lines);
      for (const auto& task : cpu["tasks"])
        EXPECT_TRUE(task["guarantee"] == "yes" || task["task"] == text_at(remedy, "task")) << cpu;
    }
    const double scale = said["sets"][0]["cpus"][0]["scale"].as_double();
    std::vector<Line> scaled = lines;
    for (Line& line : scaled) line.budget_us = static_cast<int>(line.budget_us * scale);
    const Json other = analysed(description(rtpus, scaled))["sets"][0]["cpus"][0];
    EXPECT_TRUE(other["fits"].as_bool()) << scale << description(rtpus, lines);
    EXPECT_EQ(scale >= 1, said["sets"][0]["cpus"][0]["fits"]) << scale;
  }
  for (const char* kind : {"executor", "rate_hz", "rtpu", "criticality", "lower"}) EXPECT_GT(tried[kind], 0) << kind;
}

TEST(Schedule, ASetAtTheVeryLimitFitsWithNoTimeToSpare) {
  const std::string rtpus = "r: {policy: edf, executor: preemptive}";
  const auto said = [&](int budget_us) {
    return scheduled(description(rtpus, {{"a", "r", "low", "100", 4300}, {"b", "r", "low", "50", budget_us}}), "");
  };
  EXPECT_EQ(said(10000).code, kOk);  // 0.43 + 0.5 = 0.93
  EXPECT_NE(said(10000).out.find("  fits: every task keeps its deadline, with no time to spare\n"), std::string::npos);
  EXPECT_EQ(said(10001).code, kRefused);
}

TEST(Schedule, AMoreCriticalTaskIsNeverSaidToGiveWayToALessCriticalOne) {
  const std::vector<Line> lines = {{"a", "r", "high", "166.6666667", 2000}, {"b", "r", "high", "100", 2000},
                                   {"c", "r", "high", "83.33333333", 3000}, {"d", "r", "low", "66.66666667", 2000}};
  const Json said = analysed(description("r: {policy: muf, executor: preemptive}", lines));
  const Json remedies = said["sets"][0]["cpus"][0]["remedies"];
  EXPECT_EQ(text_at(remedies[remedies.size() - 1], "label"), "task 'd' with criticality: high") << remedies;
}

// `b`, the most critical, lifts its rtpu above the other one: once it has moved, `a` would come second and miss.
TEST(Schedule, ATaskThatMovesTakesAlongTheBandOfItsRtpu) {
  const std::vector<Line> lines = {{"a", "second", "low", "200", 1500}, {"b", "second", "high", "20", 6000},
                                   {"c", "first", "low", "20", 4000}};
  const Json said = analysed(description("first: {policy: rm}, second: {policy: rm}", lines));
  const Json remedies = said["sets"][0]["cpus"][0]["remedies"];
  EXPECT_EQ(text_at(remedies[remedies.size() - 1], "label"), "task 'a' on an rtpu of another CPU") << remedies;
  EXPECT_EQ(remedies[remedies.size() - 1]["acts"].dump(Json::Style::kAsMade),
            R"([{"act":"set","path":"rtpus/second_2","value":"{cpu: 1, policy: rm}"},)"
            R"({"act":"set","path":"tasks/a/rtpu","value":"second_2"}])");
}

TEST(Schedule, ItsActsWriteOutTheRtpuThatATextWithoutRtpusHas) {
  const std::string text =
      "subsystem: s\ntasks:\n  a: {component: t_counter, rate: 100 Hz, budget: 2 ms}\n"
      "  b: {component: t_counter, rate: 20 Hz, budget: 9 ms, alias: {count: b_count, dt: b_dt, now: b_now,\n"
      "      deadline: b_deadline, cycles: b_cycles, dropped: b_dropped, illegal: b_illegal}}\n";
  std::string kinds;
  for (const Json& remedy : analysed(text)["sets"][0]["cpus"][0]["remedies"]) {
    kinds += kind_of(remedy) + " ";
    EXPECT_EQ(changed(text, remedy)["fits"], true) << remedy;
  }
  EXPECT_EQ(kinds, "executor rate_hz new rtpu ");
}

TEST(Schedule, JudgesEachRtpuAsTheDescriptionHasIt) {
  std::string text = kTwo;
  text.replace(text.find("policy: rm"), 10, "policy: rm, executor: preemptive");
  const CommandResult mixed = scheduled(text, "");
  EXPECT_EQ(mixed.code, kOk) << mixed.err;
  EXPECT_TRUE(mixed.out.starts_with("two: configuration 'all' (start), preemptive in fast; in the other rtpus a "
                                    "running job is not preempted\n"))
      << mixed.out;
  EXPECT_EQ(scheduled(kTwo, "").out, scheduled(kTwo, "executive").out);
}

TEST(Schedule, TakesTimesFromAProfileAndSaysWhich) {
  RecordedProfile profile{"two", {{"a", 10, milliseconds(1), milliseconds(1), milliseconds(1), {}},
                                  {"gone", 10, milliseconds(1), milliseconds(1), milliseconds(1), {}}}};
  const TestFile file(to_json(profile));
  const CommandResult output = scheduled(kTwo, "preemptive", file.path());
  EXPECT_EQ(output.code, kOk);
  EXPECT_NE(output.out.find("  a     fast  low    1 ms profile  10 ms"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("  b     fast  low    9 ms budget   50 ms"), std::string::npos) << output.out;
  EXPECT_TRUE(output.err.ends_with("note: the profile has a task 'gone' that is not there\n"
                                   "note: few cycles were measured: a 10; the longest of few is no bound\n"))
      << output.err;
}

TEST(Schedule, ComparesTheBudgetsWithAProfile) {
  RecordedProfile profile{"other", {{"a", 1000, milliseconds(3), milliseconds(1), milliseconds(1), {}}}};
  const TestFile file(to_json(profile));
  const std::string said = scheduled(kTwo, "preemptive", file.path()).err;
  EXPECT_TRUE(said.ends_with(
      "note: the profile was recorded of subsystem 'other': tasks of the same name have their times from it\n"
      "note: task 'a' was seen to take 3 ms, more than its budget of 2 ms\n"))
      << said;
}

TEST(Schedule, NamesARemedyForATaskWithoutATime) {
  const CommandResult output = scheduled("subsystem: s\ntasks:\n  a: {component: t_counter}\n", "");
  EXPECT_EQ(output.code, kOk);
  EXPECT_NE(output.out.find("  no budget given for a: ignored in this proof; write 'budget:', or record one: "
                            "chimera profile --save FILE, then --profile FILE\n"),
            std::string::npos)
      << output.out;
  EXPECT_NE(output.out.find("  nothing to judge: no task has a budget or a recorded time\n"), std::string::npos)
      << output.out;
}

TEST(Schedule, TheLegendOfTheWindowNamesTheTasksInIt) {
  const std::string text = description("r: {policy: rm, executor: preemptive}",
                                       {{"a", "r", "low", "1000", 10}, {"b", "r", "low", "1", 300000}});
  const CommandResult output = scheduled(text, "");
  EXPECT_NE(output.out.find("\n          B = b\n          . = idle\n          too short to be seen here: a\n"),
            std::string::npos)
      << output.out;
}

TEST(Schedule, RefusesAnIllegalDescriptionAsCheckDoes) {
  const CommandResult output = scheduled("subsystem: s\ntasks:\n  a: {component: nothing}\n", "");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(output.out, "");
  EXPECT_NE(output.err.find("nothing"), std::string::npos);
}

TEST(Schedule, RefusesAFileThatIsNoProfile) {
  const TestFile file("{}");
  const CommandResult output = scheduled(kTwo, "", file.path());
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(output.err, file.path() + ": error: is no recorded profile: $: the key \"version\" is missing; "
                                        "`chimera profile --save FILE` writes one\n");
}

TEST(TimeText, WritesTimesAsPeopleDo) {
  EXPECT_EQ(time_text(Nanoseconds{999}), "999 ns");
  EXPECT_EQ(time_text(microseconds(1500)), "1.5 ms");
  EXPECT_EQ(time_text(seconds(2)), "2 s");
}

}  // namespace
}  // namespace chimera::cli
