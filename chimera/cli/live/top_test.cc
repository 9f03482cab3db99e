// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/live/top.h"

#include <gtest/gtest.h>

#include "chimera/cli/live/testing/test_answers.h"
#include "chimera/cli/print/columns.h"
#include "chimera/text/json.h"

namespace chimera::cli::top_test {
namespace {

Json status() { return Json::parse(test::kStatus); }

std::string screen(const Json& status, const Json& previous, const TopView& view) {
  std::string text;
  for (const TopLine& line : top_lines(status, previous, view)) {
    EXPECT_EQ(width_of(line.text), view.width) << line.text;
    text += "|" + line.text + "|\n";
  }
  return text;
}

std::string empty_lines(int n) {
  std::string text;
  for (int i = 0; i < n; ++i) text += "|" + std::string(80, ' ') + "|\n";
  return text;
}

TEST(Top, AScreenOf80By24ToTheLetter) {
  EXPECT_EQ(screen(status(), nullptr, {}),
      "|puma_pid: run, up 12.5 min, flag UP by spare, operator                          |\n"
      "|CPU 1 muf  servo serving, running pid.cycle                                     |\n"
      "|CPU 0 edf  spare DEAD, restarted 2 times, FLAG, 4 events lost; last end: signal~|\n"
      "|                                                                                |\n"
      "|TASK         STATE     RATE    EXEC     MAX  BUDGET USED  JITTER MISSED INPUT   |\n"
      "|trajectory   ERROR   100 Hz 4.10 us 18.2 us       -    - 12.3 us      3 -       |\n"
      "|pid          ON       1 kHz 12.1 us 30.2 us 40.0 us  76% 3.10 us      0 3.12 s  |\n"
      "|arm          ON       1 kHz 98.7 us  149 us  150 us  99%       -     12 530 us  |\n"
      "|pid_spare    none     1 kHz       -       -       -    -       -      0 never   |\n" +
      empty_lines(14) +
      "|q quit  h help  sort: o order  n name  e exec  b used  j jitter  m missed  a age|\n");
}

TEST(Top, WithoutKeysItEndsBeforeTheirLine) {
  const std::string with_keys = screen(status(), nullptr, {});
  EXPECT_EQ(screen(status(), nullptr, {.has_keys = false}), with_keys.substr(0, with_keys.find("|q quit")));
  Json named = status();
  named["tasks"][0]["task"] = "q quit";  // no word of a line ends the screen
  EXPECT_NE(screen(named, nullptr, {.has_keys = false}).find("|arm "), std::string::npos);
}

TEST(Top, ANarrowScreenKeepsTheMissedDeadlinesWhole) {
  Json many = status();
  many["tasks"][2]["missed"] = 2231;
  for (const std::size_t width : {79u, 71u, 63u, 55u}) {
    const std::vector<TopLine> lines = top_lines(many, nullptr, {.width = width, .height = 12});
    EXPECT_NE(lines[4].text.find(" MISSED"), std::string::npos) << lines[4].text;
    EXPECT_NE(lines[7].text.find(" 2231"), std::string::npos) << lines[7].text;
  }
}

TEST(Top, TheHelpExplainsEveryColumn) {
  std::string text;
  for (const TopLine& line : help_lines({})) text += line.text + "\n";
  for (const char* column : {"RATE", "EXEC", "MAX", "BUDGET", "USED", "JITTER", "MISSED", "INPUT"})
    EXPECT_NE(text.find(column), std::string::npos) << column;
  EXPECT_EQ(help_lines({}).size(), 24u);
}

Json later() {
  Json json = status();
  json["now_ns"] = 757'000'000'000;
  json["tasks"][1]["cycles"] = 751'996;  // 998 a second, at 30 us each
  json["tasks"][1]["execution_ns"]["mean"] = 12148;
  json["tasks"][2]["missed"] = 13;
  return json;
}

TEST(Top, RateAndExecutionTimeAreThoseSinceTheLastLook) {
  const std::vector<TopLine> lines = top_lines(later(), status(), {});
  EXPECT_EQ(lines[6].text.substr(0, 35), "pid          ON      998 Hz 30.2 us") << lines[6].text;
  EXPECT_EQ(lines[7].text.substr(19, 8), "       -") << "arm did not run";
}

TEST(Top, ATaskThatWasMadeAnewStartsItsFiguresAnew) {
  Json json = later();
  json["tasks"][1]["incarnation"] = 2;
  EXPECT_EQ(top_lines(json, status(), {})[6].text.substr(21, 6), " 1 kHz");
}

TEST(Top, AlarmsAreErrorsNewMissesTheFlagAndDeadRtpus) {
  const std::vector<TopLine> lines = top_lines(later(), status(), {});
  const std::vector<TopLine::Look> expected = {TopLine::Look::kAlarm, TopLine::Look::kPlain, TopLine::Look::kAlarm,
                                               TopLine::Look::kPlain, TopLine::Look::kHeading, TopLine::Look::kAlarm,
                                               TopLine::Look::kPlain, TopLine::Look::kAlarm, TopLine::Look::kFaint};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(lines[i].look, expected[i]) << lines[i].text;
}

std::string names(TopOrder order) {
  std::string all;
  const std::vector<TopLine> lines = top_lines(status(), nullptr, {.order = order});
  for (std::size_t i = 5; i < 9; ++i) all += lines[i].text.substr(0, lines[i].text.find(' ')) + " ";
  return all;
}

TEST(Top, EveryKeySortsItsColumn) {
  EXPECT_EQ(names(TopOrder::kFile), "trajectory pid arm pid_spare ");
  EXPECT_EQ(names(TopOrder::kName), "arm pid pid_spare trajectory ");
  EXPECT_EQ(names(TopOrder::kExecution), "arm pid trajectory pid_spare ");
  EXPECT_EQ(names(TopOrder::kBudget), "arm pid trajectory pid_spare ");
  EXPECT_EQ(names(TopOrder::kJitter), "trajectory pid arm pid_spare ");
  EXPECT_EQ(names(TopOrder::kMissed), "arm trajectory pid pid_spare ");
  EXPECT_EQ(names(TopOrder::kAge), "pid_spare pid arm trajectory ");
  EXPECT_EQ(order_of_key('m'), TopOrder::kMissed);
  EXPECT_EQ(order_of_key('x'), std::nullopt);
}

TEST(Top, CountsTasksThatDoNotFitAndScrollsToThem) {
  const TopView view{.height = 8, .skipped = 99};
  const std::vector<TopLine> lines = top_lines(status(), nullptr, view);
  ASSERT_EQ(lines.size(), 8u);
  EXPECT_EQ(most_skipped(status(), view), 2u);
  EXPECT_EQ(lines[5].text.substr(0, 4), "arm ");
  EXPECT_EQ(lines[6].text.substr(0, 10), "pid_spare ");
  EXPECT_EQ(lines[7].text.substr(0, 16), "2 more: up, down");
}

TEST(Top, EverySizeIsFilledExactly) {
  for (std::size_t height = 0; height < 30; ++height)
    for (std::size_t width : {0, 1, 7, 79, 80, 81, 120, 200}) {
      const std::vector<TopLine> lines = top_lines(later(), status(), {.width = width, .height = height});
      ASSERT_EQ(lines.size(), height);
      for (const TopLine& line : lines) ASSERT_EQ(width_of(line.text), width) << line.text;
    }
}

Json served(std::int64_t on, std::int64_t busy) {
  Json json = status();
  Json& pid = json["tasks"][1];
  pid["server"] = {{"kind", "deferrable"}, {"capacity_ns", 2'000'000}, {"period_ns", 10'000'000}};
  pid["on_ns"] = on;
  pid["busy_ns"] = busy;
  return json;
}

TEST(Top, ShowsTheCapacityOfAServerAndItsUseSinceTheLastPoll) {
  const Json first = served(1'000'000'000, 10'000'000);
  EXPECT_EQ(top_lines(first, nullptr, {})[6].text.substr(44, 12), "2.00 ms   5%") << "of 200 ms since it is ON";
  Json then = served(2'000'000'000, 110'000'000);
  then["now_ns"] = 756'000'000'000;
  EXPECT_EQ(top_lines(then, first, {})[6].text.substr(44, 12), "2.00 ms  50%");
}

TEST(Top, AWideScreenShowsRareCounters) {
  Json json = status();
  json["tasks"][1]["demoted"] = 2;
  json["tasks"][1]["preempted"] = 1'200'000;
  const std::vector<TopLine> lines = top_lines(json, nullptr, {.width = 130});
  EXPECT_NE(lines[6].text.find("q_ref  2 demoted, 1.20M preempted"), std::string::npos) << lines[6].text;
}

TEST(Top, AWideScreenMarksAStandby) {
  Json json = status();
  json["tasks"][3]["standby_for"] = "pid";
  const std::vector<TopLine> lines = top_lines(json, nullptr, {.width = 130});
  EXPECT_NE(lines[8].text.find("q_ref  standby for pid"), std::string::npos) << lines[8].text;
}

TEST(Top, ShowsARateOfThreeDigits) {
  Json json = status();
  json["tasks"][1]["rate_hz"] = 1950;
  EXPECT_NE(top_lines(json, nullptr, {})[6].text.find(" 1.95 kHz "), std::string::npos);
}

TEST(Top, AWideScreenNamesTheOldestInput) {
  const std::vector<TopLine> lines = top_lines(status(), nullptr, {.width = 110});
  EXPECT_NE(lines[6].text.find("3.12 s   q_ref"), std::string::npos) << lines[6].text;
  EXPECT_NE(lines[8].text.find("never    q_ref"), std::string::npos) << lines[8].text;
}

}  // namespace
}  // namespace chimera::cli::top_test
