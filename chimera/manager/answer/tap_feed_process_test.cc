// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/answer/tap_feed.h"

#include <gtest/gtest.h>

#include "chimera/manager/testing/fake_subsystem.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

class TapFeedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fake_.start_manager();
    ASSERT_TRUE(fake_.until_on("law"));
  }
  ManagerState& state() { return fake_.loop().state(); }
  VariableId variable(const char* name) { return *state().readings->find(name); }
  void pump(TapFeed& feed) {
    feed.pump([this](Json message) { messages_.push_back(std::move(message)); });
  }
  /// Pumps often enough for one whole ring and for another that hardly changes.
  void pump_a_ring(TapFeed& feed) {
    for (std::size_t taken = 0; taken < 2 * kTapRecords; taken += 4096) pump(feed);
  }
  bool pump_until(TapFeed& feed, std::size_t rows, const char* key = "rows") {
    return fake_.until([&] {
      pump(feed);
      std::size_t n = 0;
      for (const Json& message : messages_) n += message.at(key).size();
      return n >= rows;
    });
  }
  /// The rtpu `spare` stops, and its ring is overwritten once.
  void overwrite_spare() {
    Tap writer(const_cast<TapRing&>(fake_.rtpu(1).block().tap()));
    fake_.rtpu(1).die();
    for (std::size_t i = 0; i < kTapRecords + 10; ++i) writer.append(TapRecord{});
  }
  struct Seen {
    std::uint64_t lost = 0, records = 0;
  };
  Seen seen_of_spare() const {
    Seen seen;
    for (const Json& message : messages_) {
      if (message["rtpu"] != "spare") continue;
      EXPECT_EQ(message["first"], seen.lost + seen.records);
      seen.lost += message["lost"].as_uint64();
      seen.records += message["records"].size();
    }
    return seen;
  }
  bool is_tapped(const char* task) { return state().own.block().view().is_tapped(fake_.task(task)); }

  FakeSubsystem fake_;
  std::vector<Json> messages_;
};

TEST_F(TapFeedTest, EveryPublicationComesOnceInOrder) {
  TapFeed feed(state(), {variable("x"), variable("tau")});
  EXPECT_TRUE(is_tapped("sensor") && is_tapped("law"));
  EXPECT_FALSE(is_tapped("filter"));
  ASSERT_TRUE(pump_until(feed, 200));
  std::map<std::string, std::uint64_t> next, sequence;
  for (const Json& message : messages_) {
    const std::string task = message["task"].as_string();
    EXPECT_EQ(message["rtpu"], task == "sensor" ? "servo" : "spare");
    EXPECT_EQ(message["variables"], Json::array({task == "sensor" ? "x" : "tau"}));
    EXPECT_EQ(message["first"], next[task]);
    EXPECT_EQ(message["lost"], 0);
    next[task] += message["rows"].size();
    for (const Json& row : message["rows"]) {
      ASSERT_EQ(row.size(), 3u);
      EXPECT_EQ(row[2].size(), task == "sensor" ? 2u : 1u);
      EXPECT_EQ(row[2][0].as_double(), row[1].as_double());  // the fake publishes its count
      EXPECT_TRUE(sequence[task] == 0 || row[1] == sequence[task] + 1);
      sequence[task] = row[1].as_uint64();
    }
  }
  EXPECT_GT(next["sensor"], 0u);
  EXPECT_GT(next["law"], 0u);
}

TEST_F(TapFeedTest, ATaskIsTappedUntilTheLastFeedEnds) {
  auto first = std::make_unique<TapFeed>(state(), std::vector{variable("x")});
  auto second = std::make_unique<TapFeed>(state(), std::vector{variable("x")});
  first.reset();
  EXPECT_TRUE(is_tapped("sensor"));
  second.reset();
  EXPECT_FALSE(is_tapped("sensor"));
}

TEST_F(TapFeedTest, WithoutVariablesItGivesTheSchedulingRecords) {
  TapFeed feed(state(), {});
  ASSERT_TRUE(pump_until(feed, 50, "records"));
  std::map<std::string, Json> last;
  for (const Json& message : messages_)
    for (const Json& record : message["records"]) last[record[1].as_string()] = record;
  ASSERT_EQ(last.size(), 2u);
  ASSERT_EQ(last["run"].size(), 5u);
  EXPECT_EQ(last["run"][3], CHIMERA_CYCLE);
  EXPECT_EQ(last["overrun"][4], 5000);
}

TEST_F(TapFeedTest, CountsOverwrittenRecords) {
  TapFeed feed(state(), {});
  overwrite_spare();
  pump_a_ring(feed);
  const Seen spare = seen_of_spare();
  EXPECT_GE(spare.lost, 10u);
  EXPECT_GE(spare.lost + spare.records, kTapRecords + 10);
  fake_.kill_rtpu(1, SIGKILL);
}

TEST_F(TapFeedTest, FromTheOldestTheFirstRecordsComeToo) {
  ASSERT_TRUE(fake_.until([&] { return fake_.rtpu(1).block().profile(fake_.task("law")).cycles > 20; }));
  const auto first = fake_.rtpu(1).block().tap().records[0].at.count;
  TapFeed feed(state(), {}, true);
  pump(feed);
  const Json& message = messages_.at(1);
  EXPECT_EQ(message["rtpu"], "spare");
  EXPECT_EQ(message["first"], 0);
  EXPECT_EQ(message["lost"], 0);
  EXPECT_EQ(message["records"][0][0], first);
  EXPECT_GT(message["records"].size(), 20u);
}

TEST_F(TapFeedTest, AFeedFromTheOldestCountsOverwrittenRecordsAsLost) {
  overwrite_spare();
  const std::uint64_t written = fake_.rtpu(1).block().tap().head;
  TapFeed feed(state(), {}, true);
  pump_a_ring(feed);
  const Seen spare = seen_of_spare();
  EXPECT_GE(spare.lost, 10u);
  EXPECT_EQ(spare.lost + spare.records, written);
  fake_.kill_rtpu(1, SIGKILL);
}

TEST_F(TapFeedTest, OnePumpTakesABoundedNumberOfRecordsAndTheRestComesNext) {
  TapFeed feed(state(), {});
  overwrite_spare();
  std::uint64_t before = 0;
  for (int n = 0; n < 5; ++n) {
    pump(feed);
    const std::uint64_t now = seen_of_spare().records;
    EXPECT_LE(now - before, 4096u);
    before = now;
  }
  EXPECT_GT(before, 8000u) << "two rings share";
  fake_.kill_rtpu(1, SIGKILL);
}

TEST_F(TapFeedTest, TheLastRowsOfADeadOneAreReadFromItsSegment) {
  TapFeed feed(state(), {variable("tau")});
  ASSERT_TRUE(pump_until(feed, 5));
  fake_.kill_rtpu(1, SIGKILL);
  const std::uint64_t cycles = fake_.rtpu(1).block().profile(fake_.task("law")).cycles;
  ASSERT_TRUE(fake_.until([&] { return state().rtpus[1].restarts == 1 && state().rtpus[1].is_up; }));
  pump(feed);
  std::uint64_t last = 0;
  for (const Json& message : messages_)
    for (const Json& row : message["rows"]) last = std::max(last, row[1].as_uint64());
  EXPECT_EQ(last, cycles);
}

TEST_F(TapFeedTest, GoesOnWithTheNextIncarnation) {
  TapFeed feed(state(), {variable("tau")});
  ASSERT_TRUE(pump_until(feed, 5));
  messages_.clear();
  fake_.kill_rtpu(1, SIGKILL);
  ASSERT_TRUE(fake_.until([&] {
    pump(feed);
    return state().rtpus[1].restarts == 1 && state().state(fake_.task("law")) == State::kOn;
  }));
  messages_.clear();
  EXPECT_TRUE(pump_until(feed, 5));
}

}  // namespace
}  // namespace chimera::manager
