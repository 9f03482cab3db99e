// SPDX-License-Identifier: Apache-2.0
// Correct texts and their drafts. Wrong texts and their messages are in tests/verify/faulty.
#include "chimera/description/draft.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace chimera::draft_test {
namespace {

ReadDescription read(std::string_view text) { return read_description(text, "demo.yaml"); }

Draft draft(std::string_view text) {
  ReadDescription reading = read(text);
  EXPECT_TRUE(reading.report.is_legal()) << reading.report.text();
  return reading.draft.value_or(Draft{});
}

TEST(Draft, KeepsThePlaceOfEveryValue) {
  const Draft d = draft("subsystem: demo\ntasks:\n  pid:\n    rate:   1 kHz\n    alias: {q: [a, b]}\n");
  EXPECT_EQ(d.subsystem.at, (Place{1, 12}));
  ASSERT_EQ(d.tasks.size(), 1u);
  const DraftTask& task = d.tasks[0];
  EXPECT_EQ(task.name.at, (Place{3, 3}));
  EXPECT_EQ(task.rate->at, (Place{4, 13}));
  EXPECT_EQ(task.rate->value.period, Nanoseconds{1'000'000});
  EXPECT_EQ(task.alias[0].port.at, (Place{5, 13}));
  EXPECT_EQ(task.alias[0].variables[1].at, (Place{5, 20}));
}

TEST(Draft, CountsColumnsAndLinesWithByteOrderMarkAndCarriageReturns) {
  const Draft d = draft("\xEF\xBB\xBFsubsystem: demo\r\ntasks: {pid: }\r\n");
  EXPECT_EQ(d.subsystem.text, "demo");
  EXPECT_EQ(d.tasks[0].name.at, (Place{2, 9}));
}

TEST(Draft, NamesTheComponentAfterTheTask) {
  const Draft d = draft("subsystem: demo\ntasks: {pid: , other: {component: pid}}\n");
  EXPECT_EQ(d.tasks[0].component.text, "pid");
  EXPECT_EQ(d.tasks[1].component.text, "pid");
  EXPECT_EQ(d.tasks[1].component.at, (Place{2, 35}));
}

TEST(Draft, ReadsNumbersAsDecimal) {
  const Draft d = draft("subsystem: demo\nrtpus: {a: {cpu: 010}}\ntasks: {pid: {user_priority: 08}}\n");
  EXPECT_EQ(d.rtpus[0].cpu.value, 10u);
  EXPECT_EQ(d.tasks[0].user_priority->value, 8u);
}

TEST(Draft, TakesOnAndYesForNames) {
  const Draft d = draft("subsystem: on\ntasks: {yes: , no: }\nstart: off\n");
  EXPECT_EQ(d.subsystem.text, "on");
  EXPECT_EQ(d.tasks[0].name.text, "yes");
  EXPECT_EQ(d.start->text, "off");
}

TEST(Draft, LeavesOutKeysThatWereNotWritten) {
  const Draft d = draft("subsystem: demo\ntasks: {pid: {alias: , constants: {}}}\n");
  const DraftTask& task = d.tasks[0];
  EXPECT_FALSE(task.rate || task.deadline || task.budget || task.server || task.standby_for || task.on_miss);
  EXPECT_TRUE(task.alias.empty() && task.constants.empty() && d.rtpus.empty() && d.configurations.empty());
}

TEST(Draft, ReadsEveryReaction) {
  const char* words[] = {"continue", "hold", "skip", "abort", "demote", "error", "{switch: rest}", "flag", "stop"};
  for (std::size_t i = 0; i < std::size(words); ++i) {
    const Draft d = draft("subsystem: demo\ntasks: {pid: {on_miss: " + std::string(words[i]) + "}}\n");
    EXPECT_EQ(d.tasks[0].on_miss->kind, static_cast<OnMiss>(i)) << words[i];
    EXPECT_EQ(d.tasks[0].on_miss->configuration.text, i == 6 ? "rest" : "");
  }
}

TEST(Draft, ReadsSizesInBytes) {
  EXPECT_EQ(draft("subsystem: d\ntasks: {a: {stack: 512 KiB}}").tasks[0].stack_bytes->value, 512u << 10);
  EXPECT_EQ(draft("subsystem: d\ntasks: {a: {stack: 64 MiB}}").tasks[0].stack_bytes->value, 64u << 20);
  EXPECT_EQ(draft("subsystem: d\ntasks: {a: {stack: 16384 B}}").tasks[0].stack_bytes->value, 16384u);
  EXPECT_FALSE(read("subsystem: d\ntasks: {a: {stack: 65 MiB}}").report.is_legal());
}

TEST(Draft, GoesOnAfterAFault) {
  const ReadDescription reading = read("subsystem: demo\ntasks: {pid: {rate: 5 km, budget: 40 us}, arm: {}}\n");
  EXPECT_EQ(reading.report.errors(), 1u);
  ASSERT_TRUE(reading.draft);
  EXPECT_EQ(reading.draft->tasks.size(), 2u);
  EXPECT_TRUE(reading.draft->tasks[0].is_partial);
  EXPECT_EQ(reading.draft->tasks[0].budget->value, Nanoseconds{40'000});
  EXPECT_FALSE(reading.draft->tasks[1].is_partial);
}

TEST(Draft, RefusesAFileThatIsNotThere) {
  EXPECT_EQ(read_description_file("/nowhere/arm.yaml").report.text(),
            "/nowhere/arm.yaml: error: the file cannot be opened: No such file or directory [file-unreadable]\n"
            "  check the path and its rights\n");
  EXPECT_EQ(read_description_file("/").report.text(),
            "/: error: the file is no ordinary file but a folder [file-unreadable]\n"
            "  a description is an ordinary file\n");
}

TEST(Draft, ReadsNoMoreOfAFileThanTheLimit) {
  const std::string path = testing::TempDir() + "draft_" + std::to_string(::getpid()) + ".yaml";
  std::ofstream(path) << "subsystem: demo\ntasks: {pid: }\n";
  EXPECT_TRUE(read_description_file(path).report.is_legal());
  std::ofstream(path) << std::string(300'000, '#');
  EXPECT_EQ(read_description_file(path).report.text(), path +
                                                           ": error: the file has more than 262144 bytes [text-size]\n"
                                                           "  split the application into subsystems\n");
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace chimera::draft_test
