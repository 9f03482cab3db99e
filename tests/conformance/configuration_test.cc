// SPDX-License-Identifier: Apache-2.0
// Cycle::configuration() and inputs that some configurations do not produce, on every executor of one context.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::configuration_test {
namespace {

/// Notes of the reader from its cycles. One run at a time.
struct Seen {
  std::vector<std::string> configurations;  // without repetitions
  std::vector<double> levels;
  Nanoseconds age;
  bool was_illegal = false;
};
Seen seen;

struct Reader {
  In<double> level{"level", "1", intermittent};
  void cycle(Cycle c) {
    const std::string now(c.configuration());
    if (seen.configurations.empty() || seen.configurations.back() != now) seen.configurations.push_back(now);
    if (seen.levels.empty() || seen.levels.back() != *level) seen.levels.push_back(*level);
    seen.age = level.age();
    seen.was_illegal = seen.was_illegal || c.illegal();
  }
};
struct Low {
  Out<double> level{"level", "1", initial = 0.0};
  void cycle(Cycle) { *level = 1; }
};
struct High {
  Out<double> level{"level", "1", initial = 0.0};
  void cycle(Cycle) { *level = 2; }
};
struct Other {
  Out<double> other{"other", "1", initial = 0.0};
  void cycle(Cycle) {}
};

constexpr TaskId kReader{0u}, kLow{1u}, kHigh{2u}, kOther{3u};
constexpr std::uint32_t kHighSet = 1, kBareSet = 2;
using Names = std::vector<std::string>;

class ConfigurationInForce : public OneContext {
 protected:
  ConfigurationInForce() { seen = {}; }
  void describe(testing::TestApplication& app) override {
    app.add("reader", testing::component<Reader>("reader")).budget = microseconds(20);
    app.add("low", testing::component<Low>("low")).budget = microseconds(20);
    app.add("high", testing::component<High>("high")).budget = microseconds(20);
    app.add("other", testing::component<Other>("other")).budget = microseconds(20);
    for (TaskSpec& task : app.tasks) task.rtpu = RtpuId{0u};
    app.make({kReader, kLow}, false);
    app.spec.sets = sets_;
  }

  std::vector<TaskId> low_{kReader, kLow}, high_{kReader, kHigh}, bare_{kReader, kOther};
  NamedSet sets_[3] = {{"low", low_}, {"high", high_}, {"bare", bare_}};
};

INSTANTIATE_TEST_SUITE_P(All, ConfigurationInForce, kEachExecutor, name_of_kind);

TEST_P(ConfigurationInForce, ChangesAtTheInstantOfASwitch) {
  const auto receipts = go(milliseconds(30), {to(kHighSet, milliseconds(10))});
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(seen.configurations, (Names{"low", "high"}));
}

TEST_P(ConfigurationInForce, IsNoneWhileATaskIsMissing) {
  go(milliseconds(30), {signal(milliseconds(10), Signal::kOff, kLow), signal(milliseconds(20), Signal::kOn, kLow)});
  EXPECT_EQ(seen.configurations, (Names{"low", "", "low"}));
}

TEST_P(ConfigurationInForce, MayLackTheProducerOfAnIntermittentInput) {
  const auto receipts = go(milliseconds(60), {to(kBareSet, milliseconds(10)), to(kHighSet, milliseconds(50))});
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[1].end, SwitchEnd::kDone);
  EXPECT_EQ(seen.configurations, (Names{"low", "bare", "high"}));
  EXPECT_EQ(seen.levels.back(), 2);
  EXPECT_EQ(seen.levels[seen.levels.size() - 2], 1) << "the last value stood";
  EXPECT_FALSE(seen.was_illegal);
}

TEST_P(ConfigurationInForce, TheAgeOfAnIntermittentInputGrowsWithoutAProducer) {
  go(milliseconds(60), {to(kBareSet, milliseconds(10))});
  EXPECT_GE(seen.age, milliseconds(45));
  EXPECT_FALSE(set_->flag().is_up());
}

}  // namespace
}  // namespace chimera::toy::configuration_test
