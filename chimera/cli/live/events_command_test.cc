// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/events_command.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "chimera/control/rotated_file.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

struct EventsCommandTest : ::testing::Test {
  EventsCommandTest() {
    EXPECT_NE(::mkdtemp(place), nullptr);
    ::setenv("XDG_STATE_HOME", place, 1);
    ::setenv("TZ", "UTC", 1);
    ::tzset();
    ::unsetenv("CHIMERA_SUBSYSTEM");
    for (const int run : {7, 8})
      for (const int number : {1, 2, 3})
        lines.push_back("{\"number\": " + std::to_string(number) + ", \"origin_ns\": " + std::to_string(run) +
                        ", \"at_ns\": 5, \"wall_ns\": " + std::to_string(1'700'000'000 + run * 100 + number) +
                        "000000000, \"kind\": \"" + (number == 3 ? "ending" : "set") + "\", \"text\": \"t\"}");
    EXPECT_TRUE(control::RotatedFile(std::string(place) + "/chimera/drive", "events").file(lines));
  }
  ~EventsCommandTest() override { std::filesystem::remove_all(place); }
  static CommandResult filed(std::vector<std::string> words) {
    words.insert(words.begin(), "events");
    const Error why{ErrorCode::kNotFound, {"no subsystem runs"}, {}};
    return filed_events(read_call(shell_words(), words, "").call, "", why);
  }

  char place[40] = "/tmp/chimera_events_XXXXXX";
  std::vector<std::string> lines;
};

TEST_F(EventsCommandTest, OfTheLastRunComeFromTheFileOfASubsystemThatDoesNotRun) {
  EXPECT_EQ(filed({}).out, "     1  2023-11-14 22:26:41.000  set              t\n"
                           "     2  2023-11-14 22:26:42.000  set              t\n"
                           "     3  2023-11-14 22:26:43.000  ending           t\n");
  EXPECT_EQ(filed({}).err, "'drive' does not run: from " + std::string(place) + "/chimera/drive/events.jsonl\n");
  EXPECT_EQ(filed({"--since", "3"}).out, "     3  2023-11-14 22:26:43.000  ending           t\n");
  EXPECT_EQ(filed({"--since", "4"}).out, "");
  const Json answer = Json::parse(filed({"--kind", "ending", "--json"}).out);
  ASSERT_EQ(answer["events"].size(), 1u);
  EXPECT_EQ(answer["first"], 1);
  EXPECT_EQ(answer["last"], 3);
  EXPECT_EQ(answer["subsystem"], "drive");
}

TEST_F(EventsCommandTest, SinceATimeOfAllRuns) {
  EXPECT_EQ(Json::parse(filed({"--since", "2023-11-14 22:25:03", "--json"}).out)["events"].size(), 4u);
  EXPECT_EQ(Json::parse(filed({"--since", "2023-11-14", "--json"}).out)["events"].size(), 6u);
  EXPECT_EQ(filed({"--since", "1 h"}).out, "");
}

TEST_F(EventsCommandTest, WithoutASubsystemNothingIsFollowed) {
  EXPECT_EQ(filed({"--follow"}).err, "no subsystem runs\n");
  EXPECT_EQ(filed({"--follow"}).code, kRefused);
  EXPECT_EQ(filed({"--since", "soon"}).code, kUsage);
  EXPECT_EQ(filed({"--kind", "sett"}).code, kUsage);
}

}  // namespace
}  // namespace chimera::cli
