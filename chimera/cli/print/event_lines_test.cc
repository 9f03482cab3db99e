// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/event_lines.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <time.h>

#include <fstream>
#include <sstream>

#include "chimera/base/hosted/wording.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

TEST(EventLines, AreNumberedAndTimedAndCountLostEvents) {
  setenv("TZ", "UTC", 1);
  tzset();
  EXPECT_EQ(events_text(Json::parse(R"({"first": 17, "last": 18, "events": [
              {"number": 17, "at_ns": 5, "wall_ns": 1700000002123456789, "kind": "state", "task": "pid",
               "rtpu": "servo", "text": "ON -> OFF"},
              {"number": 18, "at_ns": 6, "wall_ns": 1700000003000000000, "kind": "rtpu-restarted", "rtpu": "spare",
               "text": "for the first time\u001b[2J"}]})"),
                        5),
            "(12 older events are gone)\n"
            "    17  22:13:22.123  state            pid: ON -> OFF\n"
            "    18  22:13:23.000  rtpu-restarted   spare: for the first time [2J\n");
  EXPECT_EQ(events_text(Json::parse(R"({"first": 1, "last": 0, "events": []})"), 0), "");
}

TEST(EventLines, NameTheUserWhoseRequestAnEventIs) {
  const Json events = Json::parse(R"({"first": 1, "last": 1, "events": [
      {"number": 1, "at_ns": 5, "wall_ns": 0, "kind": "set", "text": "kp = 2", "by": "operate:ann"}]})");
  EXPECT_NE(events_text(events, 0).find("set              kp = 2, by operate:ann\n"), std::string::npos);
}

TEST(EventLines, HaveADateIfAsked) {
  setenv("TZ", "UTC", 1);
  tzset();
  const Json events = Json::parse(R"({"first": 1, "last": 1, "events": [
      {"number": 1, "at_ns": 5, "wall_ns": 1700000002123456789, "kind": "set", "text": "kp = 2",
       "by": "operate:ann"}]})");
  EXPECT_EQ(events_text(events, 0, EventLines({}, true, INT64_MIN, true)),
            "     1  2023-11-14 22:13:22.123  set              kp = 2, by operate:ann\n");
  EXPECT_EQ(events_text(events, 0, EventLines({}, true, 1700000002123456790)), "") << "it is earlier";
}

TEST(Since, IsANumberAnAgeOrATime) {
  setenv("TZ", "UTC", 1);
  tzset();
  constexpr std::int64_t kNow = 1'700'000'002;  // 2023-11-14 22:13:22
  const auto seconds_of = [](const std::string& text) {
    return read_since(text, kNow * 1'000'000'000)->wall_ns / 1'000'000'000;
  };
  EXPECT_EQ(read_since("17", 0)->number, 17);
  EXPECT_FALSE(read_since("17", 0)->is_time());
  EXPECT_EQ(seconds_of("10 min"), kNow - 600);
  EXPECT_EQ(seconds_of("22:13"), kNow - 22);
  EXPECT_EQ(seconds_of("22:13:22"), kNow);
  EXPECT_EQ(seconds_of("22:13:23"), kNow + 1 - 86400) << "yesterday";
  EXPECT_EQ(seconds_of("2023-11-14"), kNow - kNow % 86400);
  EXPECT_EQ(seconds_of("2023-11-14 22:13"), kNow - 22);
  EXPECT_EQ(seconds_of("2023-11-14T22:13:21"), kNow - 1);
  EXPECT_GT(seconds_of("9999-12-31"), kNow);
  for (const char* const wrong : {"", "-1", "1.5", "17x", "ten", "10 m", "-10 min", "25:00", "12:60", "2023-02-30",
                                  "2023-13-01", "2023-11-14 25:00", "99999999999999999999", "22:13 h"}) {
    const auto since = read_since(wrong, kNow);
    ASSERT_FALSE(since) << wrong;
    EXPECT_EQ(since.error().message.view(),
              "--since: found '" + std::string(wrong) + "', expected the number of an event, a time ago such as " +
                  "'10 min', or a time such as '14:05' or '2026-11-28 14:05'");
  }
}

Json event(int number, std::int64_t at_ms, const char* kind, const char* task, const char* text) {
  return {{"number", number},
          {"at_ns", at_ms * 1'000'000},
          {"wall_ns", 1'700'000'000'000'000'000 + at_ms * 1'000'000},
          {"kind", kind},
          {"task", task},
          {"text", text}};
}

const Json kBurst = {
    {"first", 1},
    {"last", 6},
    {"events",
     {event(1, 10, "miss", "motor", "1 deadline missed"), event(2, 10, "miss", "pi", "1 deadline missed"),
      event(3, 12, "blame", "motor", "missed its deadline: pi used 3 ms (budget 40 us)"),
      event(4, 13, "set", "", "kp 0.4 V.s/rad"), event(5, 14, "miss", "pi", "1 deadline missed (2 in all)"),
      event(6, 300, "miss", "pi", "1 deadline missed (3 in all)")}}};

TEST(EventLines, PrintMissesInARowAsOneLineAndKeepOperatorEventsApart) {
  setenv("TZ", "UTC", 1);
  tzset();
  EXPECT_EQ(
      events_text(kBurst, 0),
      "     1  22:13:20.010  miss x3          motor, pi: missed its deadline: pi used 3 ms (budget 40 us); 3 events "
      "to number 3, within 2.00 ms\n"
      "     4  22:13:20.013  set              kp 0.4 V.s/rad\n"
      "     5  22:13:20.014  miss             pi: 1 deadline missed (2 in all)\n"
      "     6  22:13:20.300  miss             pi: 1 deadline missed (3 in all)\n");
}

TEST(EventLines, AreAllTheirOwnWhenThatIsWanted) {
  const std::string text = events_text(kBurst, 0, EventLines({}, true));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
}

TEST(EventLines, AFilterByKindLeavesOutOtherKinds) {
  EXPECT_EQ(events_text(kBurst, 0, EventLines(*read_kinds("set,fault"))),
            "     4  22:13:20.013  set              kp 0.4 V.s/rad\n");
  EXPECT_EQ(read_kinds("mis").error().message.view(), "--kind: no kind 'mis'; did you mean 'miss'?");
  EXPECT_TRUE(read_kinds("xyzzy").error().message.view().starts_with("--kind: no kind 'xyzzy'; there are started,"));
}

TEST(EventLines, KnowTheKindsOfTheProtocol) {
  std::ostringstream page;
  page << std::ifstream(source_path("docs/formats/control.md")).rdbuf();
  const std::string kinds = join(event_kinds(), " ");
  EXPECT_NE(page.str().find("`kind` (" + kinds + ")"), std::string::npos) << kinds;
}

}  // namespace
}  // namespace chimera::cli
