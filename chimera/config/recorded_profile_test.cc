// SPDX-License-Identifier: Apache-2.0
#include "chimera/config/recorded_profile.h"

#include <gtest/gtest.h>

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

TEST(RecordedProfile, ReadsWhatItWrites) {
  const RecordedProfile written{"arm", {{"pid", 1000, Nanoseconds{40'000}, Nanoseconds{20'000}, Nanoseconds{90'000},
                                         Nanoseconds{5'000}},
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
  EXPECT_EQ(refusal(with("a", -4, 0)),
            "$.tasks[0].worst_ns: expected a whole number from 0 to 3600000000000");
  EXPECT_EQ(refusal(with("a", 4, 5)),
            "$.tasks[0].mean_ns: is above worst_ns");
  EXPECT_EQ(refusal(with("", 4, 4)),
            "$.tasks[0].task: expected a name of 1 to 100 bytes");
  EXPECT_NE(refusal(std::string(300'000, ' ')), "");
  EXPECT_NE(refusal("[[[[[[1]]]]]]"), "");
}

TEST(RecordedProfile, SaysWhichFileIsNotThere) {
  const auto profile = read_recorded_profile("/nowhere/p.json");
  ASSERT_FALSE(profile);
  EXPECT_EQ(profile.error().where.view(), "/nowhere/p.json");
  EXPECT_EQ(profile.error().message.view(), "No such file or directory");
}

}  // namespace
}  // namespace chimera
