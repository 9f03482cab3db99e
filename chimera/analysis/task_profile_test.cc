// SPDX-License-Identifier: Apache-2.0
#include "chimera/analysis/task_profile.h"

#include <gtest/gtest.h>

#include <cstring>

namespace chimera {
namespace {

constexpr Nanoseconds kOrigin = seconds(5);

TaskProfile sample() {
  TaskProfile made;
  made.task = "pid";
  made.component = "pid_joint";
  made.rtpu = "servo";
  made.transfer = {2, 48};
  made.state = State::kOn;
  made.period = milliseconds(1);
  made.on = milliseconds(2);
  made.server = {ServerKind::kSporadic, microseconds(200), milliseconds(1)};
  made.profile.cycles = 2;
  made.profile.execution[CHIMERA_CYCLE].add(microseconds(3));
  made.profile.execution[CHIMERA_CYCLE].add(microseconds(5));
  made.profile.response.add(microseconds(7));
  made.profile.missed = 1;
  made.profile.rejected = 4;
  made.profile.preempted = 5;
  made.profile.partial = 10;
  made.profile.tolerated = 11;
  made.profile.demoted = 6;
  made.profile.events = 9;
  made.profile.events_lost = 8;
  made.profile.exhausted = 7;
  made.faults.count = 1;
  made.faults.at = seconds(6);
  made.faults.method = Method::kCycle;
  made.faults.last.code = 12;
  std::strcpy(made.faults.last.text, "too \"hot\"");
  made.faults.notes = 3;
  std::strcpy(made.faults.note, "without its fan");
  return made;
}

TEST(TaskProfile, ReadsAsDocumented) {
  const TaskProfile task = sample();
  EXPECT_EQ(profile_json({&task, 1}, kOrigin).dump(Json::Style::kSpaced),
            "[{\"task\": \"pid\", \"component\": \"pid_joint\", \"rtpu\": \"servo\", \"state\": \"ON\", "
            "\"period_ns\": 1000000, "
            "\"server\": {\"kind\": \"sporadic\", \"capacity_ns\": 200000, \"period_ns\": 1000000}, "
            "\"on_ns\": 2000000, \"cycles\": 2, \"execution_ns\": {\"cycle\": {\"count\": 2, \"min\": 3000, "
            "\"mean\": 4000, \"max\": 5000}}, \"response_ns\": {\"count\": 1, \"min\": 7000, \"mean\": 7000, "
            "\"max\": 7000}, \"start_delay_ns\": {\"count\": 0}, \"transfer\": {\"groups\": 2, \"bytes\": 48}, "
            "\"missed\": 1, \"overrun\": 0, \"min_refused\": 0, \"dropped\": 0, \"held\": 0, \"aborted\": 0, "
            "\"partial\": 10, \"tolerated\": 11, \"stale\": 0, \"rejected\": 4, \"preempted\": 5, \"demoted\": 6, "
            "\"events\": 9, \"events_lost\": 8, \"exhausted\": 7, \"faults\": 1, \"last_fault\": "
            "{\"method\": \"cycle\", \"at_ns\": 1000000000, \"code\": 12, \"text\": \"too \\\"hot\\\"\"}, "
            "\"note\": \"without its fan\"}]");
}

TEST(TaskProfile, PrintsRestartsAndTakeoversOnlyIfThereAreAny) {
  TaskProfile task = sample();
  EXPECT_FALSE(profile_json({&task, 1}, kOrigin)[0].contains("takeovers"));
  task.profile.restarts = 2;
  task.profile.takeovers = 1;
  EXPECT_NE(profile_json({&task, 1}, kOrigin)
                .dump(Json::Style::kSpaced)
                .find("\"restarts\": 2, \"takeovers\": 1, \"faults\": 1"),
            std::string::npos);
}

TEST(TaskProfile, ReadsBackTheSame) {
  const TaskProfile task = sample();
  const Json json = profile_json({&task, 1}, kOrigin);
  const auto read = read_profiles(json, kOrigin);
  ASSERT_TRUE(read) << read.error().message.c_str();
  EXPECT_EQ(profile_json(*read, kOrigin), json);
}

TEST(TaskProfile, RefusesMalformedText) {
  EXPECT_FALSE(read_profiles(Json::parse("[{}]"), kOrigin));
  EXPECT_FALSE(read_profiles(nullptr, kOrigin));
  EXPECT_FALSE(read_profiles(Json::parse("[1]"), kOrigin));
  const TaskProfile task = sample();
  Json json = profile_json({&task, 1}, kOrigin);
  json[0]["state"] = "UP";
  const auto read = read_profiles(json, kOrigin);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message.view(), "unknown state UP");
}

}  // namespace
}  // namespace chimera
