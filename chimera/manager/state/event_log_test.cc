// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/event_log.h"

#include <gtest/gtest.h>

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

TEST(EventLog, KeepsTheLastTenThousand) {
  EventLog log;
  for (std::size_t i = 1; i <= kEventsKept + 5; ++i) log.add(said(std::to_string(i)));
  EXPECT_EQ(log.first(), 6u);
  EXPECT_EQ(log.last(), kEventsKept + 5);
  EXPECT_EQ(log.at(6).text, "6");
}

}  // namespace
}  // namespace chimera::manager
