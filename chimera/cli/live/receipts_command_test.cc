// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/receipts_command.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "chimera/control/rotated_file.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

Json receipt(int number, const char* end) {
  const bool is_done = std::string(end) == "done";
  return {{"number", number},
          {"origin_ns", 7},
          {"from", "gentle"},
          {"to", "quick"},
          {"asked_by", {{"role", "operate"}, {"user", "ann"}}},
          {"end", end},
          {"why", is_done ? Json() : Json("task 'fast' is in ERROR: clear it first")},
          {"wall_ns", std::int64_t{1'000'000'000} * 1'700'000'000},
          {"asked_ns", 1'000'000},
          {"at_ns", is_done ? Json(13'500'000) : Json()},
          {"tasks", {{{"task", "fast"}, {"lost", 0}}, {{"task", "slow"}, {"lost", 1}}}},
          {"variables", {{{"variable", "wanted"}, {"step", 2}, {"limit", 3}, {"unit", "m/s"}, {"beyond", false}},
                         {{"variable", "mode"}, {"step", nullptr}, {"unit", "1"}, {"beyond", false}},
                         {{"variable", "gain"}, {"step", 0.5}, {"limit", nullptr}, {"unit", "1"}, {"beyond", true}}}}};
}

struct ReceiptsCommandTest : ::testing::Test {
  ReceiptsCommandTest() {
    EXPECT_NE(::mkdtemp(place), nullptr);
    ::setenv("XDG_STATE_HOME", place, 1);
    ::setenv("TZ", "UTC", 1);
    ::tzset();
    ::unsetenv("CHIMERA_SUBSYSTEM");
  }
  ~ReceiptsCommandTest() override { std::filesystem::remove_all(place); }
  void file(const std::string& subsystem, int number) {
    const std::string line = "{\"number\": " + std::to_string(number) + ", \"origin_ns\": 7, \"to\": \"a\"}";
    ASSERT_TRUE(control::RotatedFile(std::string(place) + "/chimera/" + subsystem, "receipts").file({line}));
  }
  static CommandResult filed(const std::vector<std::string>& words, const std::string& subsystem = {},
                             ErrorCode code = ErrorCode::kNotFound) {
    return filed_receipts(read_call(shell_words(), words, "").call, subsystem, {code, {"no subsystem runs"}, {}});
  }

  char place[40] = "/tmp/chimera_receipts_XXXXXX";
};

TEST_F(ReceiptsCommandTest, ATakeoverNamesTheStandby) {
  Json takeover = receipt(1, "done"), aborted = receipt(2, "aborted");
  for (Json* one : {&takeover, &aborted}) {
    (*one)["way"] = "takeover";
    (*one)["to"] = "gentle";
    (*one)["asked_by"] = {{"reaction", "standby_for"}, {"lost", "fast"}, {"by", "error"}, {"task", "spare"}};
  }
  aborted["why"] = "on of task 'spare': no voltage";
  const Json answer = {{"receipts", {takeover, aborted}}, {"unfiled", 0}, {"fault", nullptr}};
  EXPECT_EQ(receipts_text(answer),
            "number  asked                by                    from    to      end       change  lost  moves\n"
            "     1  2023-11-14 22:13:20  standby_for of spare  gentle  gentle  done     12.5 ms     1  "
            "wanted 2 of 3 m/s, gain 0.5 (beyond)\n"
            "     2  2023-11-14 22:13:20  standby_for of spare  gentle  gentle  aborted        -     1\n"
            "\n"
            "takeover 2: on of task 'spare': no voltage\n");
}

TEST_F(ReceiptsCommandTest, AreATableWithUnitsAndAReasonForEachThatWasNotDone) {
  const Json answer = {{"receipts", {receipt(1, "done"), receipt(2, "refused")}}, {"unfiled", 0}, {"fault", nullptr}};
  EXPECT_EQ(receipts_text(answer),
            "number  asked                by           from    to     end       change  lost  moves\n"
            "     1  2023-11-14 22:13:20  operate:ann  gentle  quick  done     12.5 ms     1  wanted 2 of 3 m/s, "
            "gain 0.5 (beyond)\n"
            "     2  2023-11-14 22:13:20  operate:ann  gentle  quick  refused        -     -\n"
            "\n"
            "switch 2: task 'fast' is in ERROR: clear it first\n");
}

TEST_F(ReceiptsCommandTest, NameTheRequesterAndUnfiledReceipts) {
  Json task = receipt(1, "done"), reaction = task, nobody = task;
  task["asked_by"] = {{"task", "watch"}};
  reaction["asked_by"] = {{"reaction", "on_miss"}, {"task", "pid"}};
  nobody["from"] = nullptr;
  const std::string text = receipts_text(
      {{"receipts", {task, reaction, nobody}}, {"unfiled", 1}, {"fault", "/a: cannot be written: No space left"}});
  EXPECT_NE(text.find("  task watch      gentle"), std::string::npos) << text;
  EXPECT_NE(text.find("  on_miss of pid  gentle"), std::string::npos) << text;
  EXPECT_NE(text.find("  operate:ann     -     "), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\n\n1 is not filed: /a: cannot be written: No space left\n")) << text;
  EXPECT_EQ(receipts_text({{"receipts", Json::array()}, {"unfiled", 0}, {"fault", nullptr}}), "no receipts\n");
}

TEST_F(ReceiptsCommandTest, ComeFromTheFileOfASubsystemThatDoesNotRun) {
  EXPECT_EQ(filed({"receipts"}).err, "no subsystem runs\n");
  EXPECT_EQ(filed({"receipts"}).code, kRefused);
  for (const int number : {1, 2, 3}) file("drive", number);
  EXPECT_EQ(filed({"receipts"}).code, kOk) << "the only one";
  EXPECT_TRUE(filed({"receipts"}).err.starts_with("'drive' does not run: from ")) << filed({"receipts"}).err;
  const Json answer = Json::parse(filed({"receipts", "--last", "2", "--json"}).out);
  EXPECT_EQ(answer["subsystem"], "drive");
  ASSERT_EQ(answer["receipts"].size(), 2u);
  EXPECT_EQ(answer["receipts"][0]["number"], 2);
  file("arm", 1);
  EXPECT_EQ(filed({"receipts"}).code, kRefused) << "which one?";
  EXPECT_EQ(filed({"receipts"}).err,
            "no subsystem runs; receipts of earlier runs: `chimera receipts --subsystem arm`, also drive\n");
  EXPECT_EQ(filed({"receipts"}, "arm").code, kOk);
  EXPECT_EQ(filed({"receipts"}, "leg").err, "no subsystem runs\n");
  EXPECT_EQ(filed({"receipts"}, "arm", ErrorCode::kRefused).code, kRefused) << "it may run";
}

}  // namespace
}  // namespace chimera::cli
