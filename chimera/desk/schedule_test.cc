// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/schedule.h"

#include "chimera/config/recorded_profile.h"
#include "chimera/config/time_text.h"
#include "chimera/desk/test_place.h"

namespace chimera::desk {
namespace {

const std::string kTwo =
    "subsystem: two\n"
    "rtpus: {fast: {cpu: 0, policy: rm}, spare: {cpu: 1}}\n"
    "tasks:\n"
    "  a: {component: t_counter, rate: 100 Hz, budget: 2 ms, rtpu: fast, alias: {count: a_count}}\n"
    "  b: {component: t_counter, rate: 20 Hz, budget: 9 ms, rtpu: fast, alias: {count: b_count, dt: b_dt, now: b_now,\n"
    "      deadline: b_deadline, cycles: b_cycles, dropped: b_dropped, illegal: b_illegal}}\n";

Output scheduled(const std::string& text, const std::string& dispatch, const std::string& profile = "") {
  const TestFile file(text);
  return schedule({file.path(), profile, "", dispatch, false}, test_place());
}

TEST(Schedule, TellsThatEverythingFits) {
  const Output output = scheduled(kTwo, "preemptive");
  EXPECT_EQ(output.code, kOk) << output.err;
  EXPECT_EQ(output.out,
            "two: configuration 'all' (start), preemptive\n"
            "CPU 0: rtpu fast, rm; load 0.380 of at most 0.93; rate monotonic bound 0.828, hyperbolic 1.416 of 2\n"
            "  task  rtpu  crit.  time         period  deadline  response  blocked  copies  deadline is\n"
            "  a     fast  low    2 ms budget  10 ms   10 ms     2 ms      -        -       kept\n"
            "  b     fast  low    9 ms budget  50 ms   50 ms     13 ms     -        -       kept\n"
            "  fits: every task keeps its deadline\n"
            "  worst window, a letter for 500 us:\n"
            "       0  AAAABBBBBBBBBBBBBBBBAAAABB\n"
            "          A = a\n"
            "          B = b\n"
            "          . = nobody\n");
}

TEST(Schedule, TellsWhoMissesInAnExecutiveAndWhatWouldHelp) {
  const Output output = scheduled(kTwo, "executive");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_NE(output.out.find("  a     fast  low    2 ms budget  10 ms   10 ms     at most 11 ms  9 ms     -       "
                            "NOT KEPT\n"),
            std::string::npos)
      << output.out;
  EXPECT_NE(output.out.find("  does not fit\n  guaranteed: b\n  not guaranteed: a\n  first to give way: b\n"
                            "  would fit: task 'a' at rate: 90.9 Hz\n         or: task 'b' on rtpu: spare\n"),
            std::string::npos)
      << output.out;
}

TEST(Schedule, ASetThatTakesMoreThanThereIsIsAnalysedAndToldWhatFits) {
  std::string text = kTwo;
  text.replace(text.find("budget: 9 ms"), 12, "budget: 45 ms");
  const Output output = scheduled(text, "preemptive");
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

TEST(Schedule, JudgesEachUnitAsTheDescriptionHasIt) {
  std::string text = kTwo;
  text.replace(text.find("policy: rm"), 10, "policy: rm, executor: preemptive");
  const Output mixed = scheduled(text, "");
  EXPECT_EQ(mixed.code, kOk) << mixed.err;
  EXPECT_TRUE(mixed.out.starts_with("two: configuration 'all' (start), preemptive in fast; in the other rtpus a job "
                                    "that runs is not taken off\n"))
      << mixed.out;
  EXPECT_EQ(scheduled(kTwo, "").out, scheduled(kTwo, "executive").out);
}

TEST(Schedule, TakesTimesFromAProfileAndSaysWhich) {
  RecordedProfile profile{"two", {{"a", 10, milliseconds(1), milliseconds(1), milliseconds(1), {}},
                                  {"gone", 10, milliseconds(1), milliseconds(1), milliseconds(1), {}}}};
  const TestFile file(to_json(profile));
  const Output output = scheduled(kTwo, "preemptive", file.path());
  EXPECT_EQ(output.code, kOk);
  EXPECT_NE(output.out.find("  a     fast  low    1 ms profile  10 ms"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("  b     fast  low    9 ms budget   50 ms"), std::string::npos) << output.out;
  EXPECT_NE(output.err.find("note: the profile has a task 'gone' that is not there\n"), std::string::npos);
}

TEST(Schedule, SaysWhatToDoAboutATaskWithoutATime) {
  const Output output = scheduled("subsystem: s\ntasks:\n  a: {component: t_counter}\n", "");
  EXPECT_EQ(output.code, kOk);
  EXPECT_NE(output.out.find("  without a time, counted as nothing: a; write 'budget:', or record one: "
                            "chimera profile --save FILE, then --profile FILE\n"),
            std::string::npos)
      << output.out;
}

TEST(Schedule, RefusesWhatIsNotLegalAsCheckDoes) {
  const Output output = scheduled("subsystem: s\ntasks:\n  a: {component: nothing}\n", "");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(output.out, "");
  EXPECT_NE(output.err.find("nothing"), std::string::npos);
}

TEST(Schedule, RefusesAProfileThatIsNone) {
  const TestFile file("{}");
  const Output output = scheduled(kTwo, "", file.path());
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
}  // namespace chimera::desk
