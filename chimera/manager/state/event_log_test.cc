// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/event_log.h"

#include <gtest/gtest.h>

#include <numeric>

namespace chimera::manager {
namespace {

LoggedEvent said(const std::string& text) {
  LoggedEvent event;
  event.text = text;
  return event;
}

TEST(EventLog, BeforeTheFirstItIsEmpty) {
  const EventLog log;
  EXPECT_EQ(log.first(), 1u);
  EXPECT_EQ(log.last(), 0u);
}

TEST(EventLog, GoesOnBehindThePredecessorsLastNumber) {
  EventLog log(230);
  EXPECT_EQ(log.first(), 231u);
  log.add(said("a"));
  log.add(said("b"));
  EXPECT_EQ(log.first(), 231u);
  EXPECT_EQ(log.last(), 232u);
  EXPECT_EQ(log.at(231).text, "a");
  EXPECT_EQ(log.at(232).number, 232u);
}

std::vector<LoggedEvent> numbered(std::vector<std::uint64_t> numbers) {
  std::vector<LoggedEvent> events;
  for (const std::uint64_t number : numbers) {
    events.push_back(said(std::to_string(number)));
    events.back().number = number;
  }
  return events;
}

TEST(EventLog, RecallsEventsOfDeadManagersUpToAGap) {
  EventLog log(7);
  log.add(said("own"));
  log.recall(numbered({1, 2, 4, 5, 6, 6, 7, 8, 9}));
  EXPECT_EQ(log.first(), 4u) << "event 3 is lost";
  EXPECT_EQ(log.at(6).text, "6");
  EXPECT_EQ(log.at(8).text, "own") << "an event of this manager is not replaced";
  log.recall(numbered({1, 2}));
  EXPECT_EQ(log.first(), 4u);
  log.recall({});
}

TEST(EventLog, RecallsNoMoreThanItKeeps) {
  EventLog log(kEventsKept);
  for (int i = 0; i < 5; ++i) log.add(said("own"));
  std::vector<std::uint64_t> numbers(kEventsKept);
  std::iota(numbers.begin(), numbers.end(), 1u);
  log.recall(numbered(numbers));
  EXPECT_EQ(log.first(), 6u);
  EXPECT_EQ(log.at(6).text, "6");
}

TEST(EventLog, KeepsTheLastTenThousand) {
  EventLog log;
  for (std::size_t i = 1; i <= kEventsKept + 5; ++i) log.add(said(std::to_string(i)));
  EXPECT_EQ(log.first(), 6u);
  EXPECT_EQ(log.last(), kEventsKept + 5);
  EXPECT_EQ(log.at(6).text, "6");
}

}  // namespace
}  // namespace chimera::manager
