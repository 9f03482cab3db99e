// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/run_verdict.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace chimera::cli {
namespace {

TaskProfile task(const std::string& name, State state = State::kOn) {
  TaskProfile made;
  made.task = name;
  made.state = state;
  return made;
}

RunVerdict judged(const std::vector<TaskProfile>& tasks, const std::vector<RtpuFate>& rtpus = {},
                  bool is_flag_up = false, bool is_strict = false, std::vector<std::uint64_t> faults_before = {}) {
  return judge_run({tasks, faults_before, rtpus, is_flag_up, is_strict});
}

TaskProfile with_fault(TaskProfile of, Method method, const char* text) {
  of.faults.count = 1;
  of.faults.method = method;
  std::snprintf(of.faults.last.text, sizeof of.faults.last.text, "%s", text);
  return of;
}

TEST(RunVerdict, AGoodRunIsOneLineAndASuccessStrictToo) {
  for (const bool is_strict : {false, true}) {
    const RunVerdict verdict = judged({task("pi"), task("arm", State::kOff)}, {{.name = "servo"}}, false, is_strict);
    EXPECT_EQ(verdict.text(), "clean: no deadline missed, no release dropped, no fault, no restart\n");
    EXPECT_FALSE(verdict.is_failure());
  }
}

TEST(RunVerdict, ARunThatWasNotRealTimeIsNotCleanUnlessThatWasAskedFor) {
  const char* why = "no PREEMPT_RT in the kernel: nothing bounds the jitter";
  const RunVerdict verdict = judged({task("pi")}, {{.name = "servo", .not_real_time = why}}, false, true);
  EXPECT_EQ(verdict.text(), "not clean: servo was not real time: " + std::string(why) +
                                "\nFAILED: not clean, and --strict makes that a failure\n");
  const char* asked = "memory not locked; ordinary scheduling was asked for (priority 0): any job may come late";
  EXPECT_TRUE(judged({task("pi")}, {{.name = "servo", .not_real_time = asked}}).is_clean());
}

TEST(RunVerdict, ADeathThatWasAskedForIsNotCleanAndFailsOnlyAStrictRun) {
  TaskProfile lost = task("pi", State::kError);
  lost.rtpu = "servo";
  const std::vector<RtpuFate> rtpus = {{.name = "servo", .died = milliseconds(1500)}};
  EXPECT_EQ(judged({lost}, rtpus).text(), "not clean: servo died at 1.500 s and is not restarted\n");
  EXPECT_FALSE(judged({lost}, rtpus).is_failure());
  EXPECT_TRUE(judged({lost}, rtpus, false, true).is_failure());
  lost.rtpu = "plan";
  EXPECT_TRUE(judged({lost}, rtpus).is_failure()) << "another rtpu";
}

TEST(RunVerdict, PrintsCountsByTaskAndFailsOnlyAStrictRun) {
  TaskProfile pi = task("pi"), arm = task("arm");
  pi.profile.missed = 12;
  arm.profile.missed = 9;
  arm.profile.tolerated = 1;
  pi.profile.dropped = 1;
  const RunVerdict verdict = judged({pi, arm, task("log")}, {}, true);
  EXPECT_EQ(verdict.text(),
            "not clean: 20 deadlines missed (pi 12, arm 8), 1 release dropped (pi 1), "
            "the illegal-configuration flag is up\n");
  EXPECT_FALSE(verdict.is_failure());
  const RunVerdict strict = judged({pi}, {}, false, true);
  EXPECT_EQ(strict.text(),
            "not clean: 12 deadlines missed (pi 12), 1 release dropped (pi 1)\n"
            "FAILED: not clean, and --strict makes that a failure\n");
  EXPECT_TRUE(strict.is_failure());
}

TEST(RunVerdict, MissesThatMayBeAreNoneAndTheFlagAloneIsNotClean) {
  TaskProfile display = task("display");
  display.profile.missed = display.profile.tolerated = 5;
  EXPECT_TRUE(judged({display}).is_clean());
  EXPECT_FALSE(judged({display}, {}, true).is_clean());
}

TEST(RunVerdict, ARestartSaysFromWhereItCounts) {
  const RunVerdict verdict = judged({task("pi")}, {{"servo", 2, milliseconds(3214)}, {"plan", 1}});
  EXPECT_EQ(verdict.text(),
            "servo: the counts of its tasks begin at its restart at 3.214 s\n"
            "plan: the counts of its tasks begin at its restart\n"
            "not clean: 2 restarts of servo, 1 restart of plan\n");
  EXPECT_FALSE(verdict.is_failure());
}

TEST(RunVerdict, ATaskOrRtpuThatIsBrokenAtTheEndFailsEveryRun) {
  EXPECT_EQ(judged({task("pi")}, {{.name = "servo", .is_given_up = true}}).text(),
            "FAILED: servo was given up: its process ended too often, its tasks did not run\n");
  EXPECT_EQ(judged({task("pi")}, {{.name = "servo", .bad_end = "ended by signal 9 (SIGKILL)"}}).text(),
            "FAILED: servo did not end in order: it ended by signal 9 (SIGKILL)\n");
  const RunVerdict error = judged({with_fault(task("pi", State::kError), Method::kCycle, "no sensor")});
  EXPECT_EQ(error.text(), "not clean: 1 fault (pi 1)\nFAILED: pi was in ERROR at the end: cycle: no sensor\n");
  EXPECT_TRUE(error.is_failure());
  const RunVerdict log = judged({with_fault(task("log"), Method::kKill, "884 rows were not written")});
  EXPECT_EQ(log.text(), "not clean: 1 fault (log 1)\nFAILED: log: kill failed: 884 rows were not written: "
            "its hardware may not be off or released\n");
  EXPECT_TRUE(log.is_failure());
}

TEST(RunVerdict, AFaultThatWasGotOverFailsOnlyAStrictRun) {
  const TaskProfile pi = with_fault(task("pi"), Method::kCycle, "no sensor");
  EXPECT_FALSE(judged({pi}).is_failure()) << "of the cycle, and the task went on";
  const TaskProfile off = with_fault(task("pi"), Method::kOff, "stuck");
  EXPECT_FALSE(judged({off}, {}, false, false, {1}).is_failure()) << "of an `off` in the middle of the run";
  EXPECT_TRUE(judged({off}, {}, false, false, {0}).is_failure());
}

TEST(RunVerdict, PrintsATaskThatMayNotBeOffOnceWithTheCause) {
  TaskProfile pi = with_fault(task("pi"), Method::kOff, "stuck"), arm = task("arm");
  pi.rtpu = arm.rtpu = "servo";
  const NotOff told[] = {{"arm", "servo ended by signal 9 (SIGKILL) in arm.off: its hardware may not be off"}};
  const RtpuFate servo{.name = "servo", .bad_end = "ended by signal 9 (SIGKILL) in arm.off"};
  const std::vector<TaskProfile> tasks = {pi, arm};
  const RunVerdict verdict = judge_run({tasks, {}, {&servo, 1}, false, false, told});
  EXPECT_EQ(verdict.text(), "not clean: 1 fault (pi 1)\n"
                            "FAILED: arm: servo ended by signal 9 (SIGKILL) in arm.off: its hardware may not be off\n"
                            "FAILED: pi: off failed: stuck: its hardware may not be off\n");
  EXPECT_EQ(verdict.not_off, (std::vector<std::string>{"arm", "pi"}));
  pi.faults.off_count = 1;
  std::snprintf(pi.faults.off_text, sizeof pi.faults.off_text, "stuck");
  EXPECT_TRUE(judged({pi}, {}, false, false, {1}).is_failure()) << "also in the middle of a run";
}

TEST(RunVerdict, ProgramsReadTheSame) {
  TaskProfile pi = task("pi");
  pi.profile.missed = 1;
  EXPECT_EQ(judged({pi}, {{"servo", 1}}, true, true).json(),
            "{\"clean\": false, \"strict\": true, \"missed\": 1, \"dropped\": 0, \"faults\": 0, \"restarts\": 1, "
            "\"remarks\": [\"1 deadline missed (pi 1)\", \"1 restart of servo\", "
            "\"the illegal-configuration flag is up\"], "
            "\"since\": [\"servo: the counts of its tasks begin at its restart\"], \"not_off\": [], \"failures\": []}");
}

}  // namespace
}  // namespace chimera::cli
