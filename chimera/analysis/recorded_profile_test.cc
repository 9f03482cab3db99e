// SPDX-License-Identifier: Apache-2.0
#include "chimera/analysis/recorded_profile.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace chimera {
namespace {

std::string refusal(const std::string& json) {
  const auto profile = parse_recorded_profile(json);
  return profile ? "" : std::string(profile.error().message.view());
}

std::string with(const std::string& task) { return R"({"version": 1, "subsystem": "s", "tasks": [)" + task + "]}"; }

std::string with(const char* name, int worst, int mean) {
  return with("{\"task\": \"" + std::string(name) + "\", \"samples\": 1, \"worst_ns\": " + std::to_string(worst) +
              ", \"mean_ns\": " + std::to_string(mean) + ", \"response_ns\": 0, \"jitter_ns\": 0}");
}

constexpr const char* kGood =
    R"({"task": "pid", "samples": 9, "worst_ns": 40, "mean_ns": 20, "response_ns": 90, "jitter_ns": 5})";

TEST(RecordedProfile, ReadsItsOwnOutput) {
  const RecordedProfile written{
      "arm",
      {{"pid", 1000, Nanoseconds{40'000}, Nanoseconds{20'000}, Nanoseconds{90'000}, Nanoseconds{5'000}},
       {"idle", 0, {}, {}, {}, {}}}};
  const auto read = parse_recorded_profile(to_json(written));
  ASSERT_TRUE(read) << read.error().message.c_str();
  EXPECT_EQ(to_json(*read), to_json(written));
  ASSERT_NE(read->find("pid"), nullptr);
  EXPECT_EQ(read->find("pid")->worst, Nanoseconds{40'000});
  EXPECT_EQ(read->find("idle"), nullptr);  // nothing was seen of it
}

TEST(RecordedProfile, NamesThePlaceOfEachFault) {
  EXPECT_EQ(refusal(with(kGood)), "");
  EXPECT_EQ(refusal(with(std::string(kGood) + "," + kGood)), "$.tasks[1].task: task 'pid' comes twice");
  EXPECT_EQ(refusal(R"({"version": 2, "subsystem": "s", "tasks": []})"), "$.version: expected 1");
  EXPECT_EQ(refusal(R"({"version": 1, "subsystem": "s"})"), "$: the key \"tasks\" is missing");
  EXPECT_EQ(refusal(R"({"version": 1, "subsystem": "s", "task": [], "tasks": []})"),
            "$: unknown key \"task\"; did you mean \"tasks\"?");
  EXPECT_EQ(refusal(with("a", -4, 0)), "$.tasks[0].worst_ns: expected a whole number from 0 to 3600000000000");
  EXPECT_EQ(refusal(with("a", 4, 5)), "$.tasks[0].mean_ns: is above worst_ns");
  EXPECT_EQ(refusal(with("", 4, 4)), "$.tasks[0].task: expected a name of 1 to 100 bytes");
  EXPECT_NE(refusal(std::string(300'000, ' ')), "");
  EXPECT_NE(refusal("[[[[[[1]]]]]]"), "");
}

TEST(RecordedProfile, SaysWhichFileIsNotThere) {
  const auto profile = read_recorded_profile("/nowhere/p.json");
  ASSERT_FALSE(profile);
  EXPECT_EQ(profile.error().where.view(), "/nowhere/p.json");
  EXPECT_EQ(profile.error().message.view(), "cannot be opened: No such file or directory");
}

TEST(RecordedProfile, TakesTheMeasuredTimes) {
  TaskProfile pid, idle;
  pid.task = "pid";
  pid.profile.execution[CHIMERA_CYCLE].add(microseconds(3));
  pid.profile.execution[CHIMERA_CYCLE].add(microseconds(5));
  pid.profile.execution[CHIMERA_INIT].add(seconds(1));
  pid.profile.response.add(microseconds(9));
  pid.profile.start_delay.add(microseconds(2));
  pid.profile.start_delay.add(microseconds(6));
  idle.task = "idle";
  idle.profile.execution[CHIMERA_CYCLE].add(Nanoseconds{0});  // virtual time without a budget
  const TaskProfile measured[] = {pid, idle};
  const auto read = parse_recorded_profile(to_json(recorded("arm", measured)));
  ASSERT_TRUE(read) << read.error().message.c_str();
  EXPECT_EQ(read->subsystem, "arm");
  ASSERT_NE(read->find("pid"), nullptr);
  EXPECT_EQ(read->find("pid")->samples, 2u);
  EXPECT_EQ(read->find("pid")->worst, microseconds(5));
  EXPECT_EQ(read->find("pid")->mean, microseconds(4));
  EXPECT_EQ(read->find("pid")->response, microseconds(9));
  EXPECT_EQ(read->find("pid")->jitter, microseconds(4));
  EXPECT_EQ(read->tasks.size(), 2u);
  EXPECT_EQ(read->find("idle"), nullptr) << "nothing is known of it";
}

TEST(RecordedProfile, IsWrittenWholeOrNotAtAll) {
  char made[] = "/tmp/chimera_profile_XXXXXX";
  const std::string folder = ::mkdtemp(made), path = folder + "/p.json";
  std::ofstream(path) << "old";
  ASSERT_TRUE(may_write_recorded_profile(path));
  const RecordedProfile profile{"arm", {}};
  ASSERT_TRUE(write_recorded_profile(path, profile));
  EXPECT_TRUE(read_recorded_profile(path));
  const auto nowhere = write_recorded_profile(folder + "/none/p.json", profile);
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().message.view(), "cannot be written: No such file or directory");
  EXPECT_EQ(may_write_recorded_profile(folder + "/none/p.json").error().message.view(), nowhere.error().message.view());
  EXPECT_EQ(write_recorded_profile(folder, profile).error().message.view(), "is no ordinary file");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "nothing is left over";
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace chimera
