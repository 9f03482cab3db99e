// SPDX-License-Identifier: Apache-2.0
#include "chimera/record/chrome_trace.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "chimera/task/state_machine.h"
#include "chimera/text/json.h"

namespace chimera {
namespace {

TapRecord record(TapKind kind, std::int64_t at, std::uint32_t task, std::uint32_t a = 0, std::int64_t b = 0) {
  TapRecord made;
  made.at = Nanoseconds{at};
  made.kind = kind;
  made.task = TaskId(task);
  made.a = a;
  made.b = b;
  return made;
}

Json trace_of(std::span<const TapRecord> records, std::uint64_t lost = 0) {
  const std::string rtpus[] = {"main"};
  const std::string tasks[] = {"pid", "say \"hi\""};
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* file = ::open_memstream(&text, &size);
  ChromeTrace trace(file, "arm", rtpus, tasks, Nanoseconds{1000});
  trace.add(records);
  EXPECT_TRUE(trace.end(lost, 2 * lost));
  std::fclose(file);
  Json parsed = Json::parse(std::string(text, size));
  std::free(text);
  return parsed;
}

TEST(ChromeTrace, IsValidJsonEvenWithoutRecords) {
  const auto trace = trace_of({});
  EXPECT_EQ(trace["traceEvents"].size(), 3u);  // names of one rtpu and two tasks
  EXPECT_EQ(trace["traceEvents"][2]["args"]["name"], "say \"hi\"");
  EXPECT_EQ(trace["otherData"]["subsystem"], "arm");
}

TEST(ChromeTrace, KeepsEveryNanosecond) {
  const TapRecord records[] = {record(TapKind::kRun, 1001, 1, CHIMERA_CYCLE, 12'345),
                               record(TapKind::kMiss, 999, 0, 0, 7)};
  const auto events = trace_of(records, 3)["traceEvents"];
  EXPECT_EQ(events[3]["name"], "miss") << "the first record comes first";
  EXPECT_EQ(events[3]["args"]["ns"], -1);
  EXPECT_EQ(events[3]["args"]["late_ns"], 7);
  EXPECT_EQ(events[4]["ph"], "X");
  EXPECT_EQ(events[4]["name"], "cycle");
  EXPECT_EQ(events[4]["tid"], 2);
  EXPECT_DOUBLE_EQ(events[4]["ts"].as_double(), 0.001);
  EXPECT_DOUBLE_EQ(events[4]["dur"].as_double(), 12.345);
  EXPECT_EQ(events[4]["args"]["ns"], 1);
  EXPECT_EQ(events[4]["args"]["dur_ns"], 12'345);
}

TEST(ChromeTrace, NamesEveryKindOfRecord) {
  const TapRecord records[] = {record(TapKind::kRelease, 1, 0, 5),
                               record(TapKind::kPreempt, 2, 0),
                               record(TapKind::kDrop, 3, 0, 2),
                               record(TapKind::kSignal, 4, 0, CHIMERA_SIGNAL_OFF, 1),
                               record(TapKind::kFault, 5, 0, CHIMERA_CYCLE),
                               record(TapKind::kState, 6, 0, static_cast<std::uint32_t>(State::kError)),
                               record(TapKind::kFlag, 7, 0, 1),
                               record(TapKind::kFlag, 8, 0, 0)};
  const auto trace = trace_of(records, 3);
  std::string names;
  for (const auto& event : trace["traceEvents"])
    if (event["ph"] == "i") names += event["name"].as_string() + ", ";
  EXPECT_EQ(names, "release, preempt, drop, signal off, fault in cycle, state ERROR, flag up, flag down, ");
  EXPECT_EQ(trace["otherData"]["lost_records"], 3);
  EXPECT_EQ(trace["otherData"]["missed_records"], 6);
}

TEST(ChromeTrace, SortsLateRecordsAndShowsDeadlines) {
  const TapRecord records[] = {record(TapKind::kRun, 3'000, 0, CHIMERA_CYCLE, 500),
                               record(TapKind::kRelease, 2'000, 0, 7, 5'000),
                               record(TapKind::kRun, 4'000, 1, CHIMERA_CYCLE, 10),
                               record(TapKind::kRelease, 4'000, 1, 8)};
  std::string seen;
  const auto trace = trace_of(records);
  for (const auto& event : trace["traceEvents"])
    if (event["ph"] != "M")
      seen += event["name"].as_string() + " " + std::to_string(event["args"]["ns"].as_int64()) + ", ";
  EXPECT_EQ(seen, "release 1000, cycle 2000, cycle 3000, release 3000, deadline 6000, ");
}

TEST(ChromeTrace, HoldsBackNoMoreThanTwoSeconds) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const TapRecord records[] = {record(TapKind::kPreempt, 5 * kSecond, 0), record(TapKind::kPreempt, 8 * kSecond, 0),
                               record(TapKind::kDrop, 1 * kSecond, 0, 1)};
  std::string seen;
  const auto trace = trace_of(records);
  for (const auto& event : trace["traceEvents"])
    if (event["ph"] != "M") seen += event["name"].as_string() + " ";
  EXPECT_EQ(seen, "preempt drop preempt ");
}

TEST(ChromeTrace, GivesRecordsWithoutATaskToTheWholeProcess) {
  TapRecord flag = record(TapKind::kFlag, 1, 0, 1);
  flag.task = TaskId();
  const TapRecord records[] = {flag, record(TapKind::kRelease, 2, 0)};
  const auto events = trace_of(records)["traceEvents"];
  EXPECT_EQ(events[3]["s"], "p");
  EXPECT_EQ(events[4]["s"], "t");
}

TEST(ChromeTrace, ReportsAFileThatCannotBeWritten) {
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  ChromeTrace trace(full, "arm", {}, {}, Nanoseconds{});
  EXPECT_FALSE(trace.end(0, 0));
  std::fclose(full);
}

TEST(MicrosecondsText, NeverRounds) {
  EXPECT_EQ(microseconds_text(Nanoseconds{0}), "0.000");
  EXPECT_EQ(microseconds_text(Nanoseconds{INT64_MAX}), "9223372036854775.807");
  EXPECT_EQ(microseconds_text(Nanoseconds{-1}), "-0.001");
}

}  // namespace
}  // namespace chimera
