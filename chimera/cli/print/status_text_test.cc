// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/status_text.h"

#include <gtest/gtest.h>

#include "chimera/cli/live/testing/test_answers.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

Json status() { return Json::parse(test::kStatus); }

TEST(OldestInput, IsNeverOneOfTheOperatorWhichHoldsUntilItIsSet) {
  const auto oldest = [](const char* inputs) { return oldest_input(Json::parse(inputs)); };
  EXPECT_EQ(oldest(R"({"inputs": [{"variable": "kp", "age_ns": 0}, {"variable": "q", "age_ns": 7}]})").variable, "q");
  EXPECT_EQ(oldest(R"({"inputs": [{"variable": "kp", "age_ns": 0}]})").variable, "");
  EXPECT_EQ(oldest(R"({"inputs": [{"variable": "q", "age_ns": 7}, {"variable": "r", "age_ns": null}]})").age_ns, -1);
}

TEST(StatusText, NamesTheCommandsThatBringBackAGivenUpRtpu) {
  Json status = chimera::cli::status();
  status["rtpus"][1]["given_up"] = true;
  status["rtpus"][1]["remedy"] = "`chimera clear trajectory`, then `chimera on trajectory`";
  const char* lines = "spare: GIVEN UP; last end: signal 11 in trajectory.cycle; its tasks count from their restart\n"
                      "  to bring it back type `chimera clear trajectory`, then `chimera on trajectory`\n";
  EXPECT_NE(status_text(status).find(lines), std::string::npos) << status_text(status);
  EXPECT_TRUE(rtpu_remarks(status["rtpus"][1]).starts_with("spare GIVEN UP, restarted 2 times"));
}

TEST(StatusText, PrintsTheLoadOfAnRtpuAndItsLostRights) {
  Json status = chimera::cli::status();
  status["rtpus"][0]["resident_bytes"] = 255'400'000;
  status["rtpus"][0]["lost_rights"] = "thread 7 runs at SCHED_OTHER instead of SCHED_FIFO 80";
  EXPECT_NE(status_text(status).find("servo    1  muf     serving  4711         0  255 MB  pid.cycle  -\n"),
            std::string::npos);
  EXPECT_NE(status_text(status).find("\nservo: RIGHTS LOST: thread 7 runs at SCHED_OTHER instead of SCHED_FIFO 80\n"),
            std::string::npos);
  EXPECT_EQ(rtpu_remarks(status["rtpus"][0]),
            "servo serving, running pid.cycle, 255 MB, RIGHTS LOST: thread 7 runs at SCHED_OTHER instead of "
            "SCHED_FIFO 80");
}

TEST(StatusText, MarksAStandby) {
  Json status = chimera::cli::status();
  status["tasks"][3]["state"] = "OFF";
  status["tasks"][3]["standby_for"] = "pid";
  EXPECT_NE(status_text(status).find("\npid_spare   OFF, standby for pid  spare "), std::string::npos)
      << status_text(status);
}

TEST(StatusText, SaysWhyAnRtpuIsNotRealTime) {
  Json status = chimera::cli::status();
  status["rtpus"][0]["not_real_time"] = "memory not locked";
  EXPECT_NE(status_text(status).find("\nservo: NOT REAL TIME: memory not locked\n"), std::string::npos);
  EXPECT_EQ(rtpu_remarks(status["rtpus"][0]), "servo serving, running pid.cycle, NOT REAL TIME");
}

TEST(StatusText, NamesAGuardThatHangsOrLacksSomethingAndTheRtpusWithoutIt) {
  Json status = chimera::cli::status();
  status["guard"] = {{"pid", 4713}, {"lack", "the guard is dead"}, {"hang", "does not run"}};
  status["rtpus"][0]["unguarded"] = "no safe frame can be written: Too many open files";
  EXPECT_NE(status_text(status).find("\nguard: HANGS: does not run\nthe guard is dead\n"
                                     "servo: NO GUARD: no safe frame can be written: Too many open files\n"),
            std::string::npos)
      << status_text(status);
}

TEST(StatusText, PrintsSubsystemRtpusAndTasks) {
  EXPECT_EQ(status_text(status()),
            "puma_pid: run, up 12.5 min, flag UP by spare, operator\n"
            "\n"
            "rtpu   cpu  policy  phase     pid  restarts  memory  running    flag\n"
            "servo    1  muf     serving  4711         0       -  pid.cycle  -\n"
            "spare    0  edf     ended    4712         2       -  -          UP\n"
            "spare: last end: signal 11 in trajectory.cycle; its tasks count from their restart\n"
            "\n"
            "task        state        rtpu     rate  cycles     mean      max   budget   jitter  missed  faults"
            "  oldest input\n"
            "trajectory  ERROR        spare  100 Hz   41234  4.10 us  18.2 us        -  12.3 us       3       1"
            "  -\n"
            "pid         ON           servo   1 kHz    750k  12.1 us  30.2 us  40.0 us  3.10 us       0       0"
            "  3.12 s q_ref\n"
            "arm         ON           servo   1 kHz    750k  98.7 us   149 us   150 us        -      12       0"
            "  530 us tau\n"
            "pid_spare   NOT-CREATED  spare   1 kHz       0        -        -        -        -       0       0"
            "  never q_ref\n"
            "trajectory: last fault: cycle: goal out of reach\n");
}

TEST(StatusText, ATaskBehindAServerShowsItAndHowMuchOfItIsUsed) {
  auto json = status();
  json["rtpus"] = Json::array();
  json["tasks"].elements().resize(2);
  auto& pid = json["tasks"][1];
  pid["server"] = {{"kind", "sporadic"}, {"capacity_ns", 2000000}, {"period_ns", 10000000}};
  pid["on_ns"] = 1000000000;
  pid["busy_ns"] = 50000000;
  pid["exhausted"] = 4;
  EXPECT_EQ(status_text(json),
            "puma_pid: run, up 12.5 min, flag UP by spare, operator\n"
            "\n"
            "task        state  rtpu     rate  cycles     mean      max   budget   jitter  missed             server"
            "     used  exhausted  faults  oldest input\n"
            "trajectory  ERROR  spare  100 Hz   41234  4.10 us  18.2 us        -  12.3 us       3                  -"
            "        -          0       1  -\n"
            "pid         ON     servo   1 kHz    750k  12.1 us  30.2 us  40.0 us  3.10 us       0  2.00 ms / 10.0 ms"
            "  25.00 %          4       0  3.12 s q_ref\n"
            "trajectory: last fault: cycle: goal out of reach\n");
}

TEST(StatusText, TheLoadOfATaskThatEventsReleaseIsMeasured) {
  const std::string text = profile_text(Json::parse(R"({"tasks": [
      {"task": "lamp", "rtpu": "servo", "state": "ON", "period_ns": 10000000, "on_ns": 1000000000, "cycles": 3,
       "server": {"kind": "deferrable", "capacity_ns": 2000000, "period_ns": 10000000},
       "execution_ns": {"cycle": {"count": 3, "min": 1000000, "mean": 2000000, "max": 3000000}},
       "response_ns": {"count": 0}, "start_delay_ns": {"count": 0}}]})"));
  EXPECT_EQ(text,
            "task  state  cycles     mean      max    load  response  jitter             server    used  missed"
            "  overrun  dropped  stale  rejected  faults\n"
            "lamp  ON          3  2.00 ms  3.00 ms  0.60 %         -       -  2.00 ms / 10.0 ms  3.00 %       0"
            "        0        0      0         0       0\n"
            "\n"
            "rtpu   tasks    load  missed  overrun  dropped  stale  rejected  faults\n"
            "servo      1  0.60 %       0        0        0      0         0       0\n");
}

TEST(StatusText, AnIdleSubsystemHasOnlyItsHeadline) {
  EXPECT_EQ(status_text(Json::parse(R"({"subsystem": "idle", "configuration": "", "started_ns": null,
              "ending": true, "flag": {"up": false, "by": []}, "rtpus": [], "tasks": []})")),
            "idle: no configuration, starting, flag down, ENDING\n");
}

TEST(StatusText, TheRemarksOnAnRtpu) {
  const auto rtpus = status().at("rtpus");
  EXPECT_EQ(rtpu_remarks(rtpus[0]), "servo serving, running pid.cycle");
  EXPECT_EQ(rtpu_remarks(rtpus[1]),
            "spare DEAD, restarted 2 times, FLAG, 4 events lost; last end: signal 11 in trajectory.cycle");
}

TEST(StatusText, TheProfileHasALineForEachTaskAndItsFaults) {
  EXPECT_EQ(profile_text(Json::parse(R"({"tasks": [
              {"task": "pid", "component": "pid_joint", "rtpu": "servo", "state": "ON", "period_ns": 1000000,
               "on_ns": 750000000000, "cycles": 750000,
               "execution_ns": {"init": {"count": 1, "min": 9, "mean": 9, "max": 9},
                                "cycle": {"count": 750000, "min": 8000, "mean": 12100, "max": 30200}},
               "response_ns": {"count": 750000, "min": 9000, "mean": 20000, "max": 71000},
               "start_delay_ns": {"count": 750000, "min": 100, "mean": 300, "max": 3200}, "missed": 1, "overrun": 2,
               "min_refused": 0, "dropped": 3, "held": 0, "aborted": 0, "stale": 4, "rejected": 5, "preempted": 6,
               "demoted": 0, "faults": 1, "transfer": {"groups": 2, "bytes": 48},
               "last_fault": {"method": "cycle", "at_ns": 1500000000, "code": 3, "text": "too hot"}},
              {"task": "arm", "state": "OFF", "period_ns": 0, "cycles": 0, "execution_ns": {},
               "response_ns": {"count": 0}, "start_delay_ns": {"count": 0}}]})")),
            "task  state  cycles     mean      max    load  response   jitter  missed  overrun  dropped  stale"
            "  rejected  preempted  faults\n"
            "pid   ON       750k  12.1 us  30.2 us  1.21 %   71.0 us  3.10 us       1        2        3      4"
            "         5          6       1\n"
            "arm   OFF         0        -        -       -         -        -       0        0        0      0"
            "         0          0       0\n"
            "pid: last fault in cycle at 1.50 s: too hot\n"
            "\n"
            "task  method  calls  mean   max\n"
            "pid   init        1  9 ns  9 ns\n"
            "\n"
            "task  groups a cycle  bytes a cycle\n"
            "pid                2             48\n"
            "\n"
            "rtpu   tasks    load  missed  overrun  dropped  stale  rejected  preempted  faults\n"
            "servo      1  1.21 %       1        2        3      4         5          6       1\n");
}

}  // namespace
}  // namespace chimera::cli
