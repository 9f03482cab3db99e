// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/subscription_feeds.h"

#include <gtest/gtest.h>

#include "chimera/manager/testing/lone_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

class SubscriptionFeedsTest : public ::testing::Test, public LoneState {
 protected:
  void open(std::uint64_t subscription, const Json& parameters) {
    const control::RpcResponse answer = feeds_.open(subscription, parameters);
    EXPECT_TRUE(answer.is_good()) << answer.message;
  }
  /// The next notification of the subscription; null: none.
  Json pull(std::uint64_t subscription) {
    const auto message = feeds_.pull(subscription);
    return message == nullptr ? Json() : *message;
  }
  void tell(int count) {
    for (int i = 0; i < count; ++i) {
      const std::string number = std::to_string(state().log.last() + 1);
      state().tell("signal", TaskId{}, RtpuId{}, "event " + number, now());
    }
  }
  bool is_tapped(const char* name) { return state().own.block().view().is_tapped(task(name)); }

  SubscriptionFeeds feeds_{state()};
};

TEST_F(SubscriptionFeedsTest, EventsComeFromTheOpeningOnWithoutSince) {
  tell(3);
  open(1, {{"to", "events"}});
  EXPECT_EQ(pull(1), Json());
  tell(2);
  const Json message = pull(1);
  EXPECT_EQ(message["lost"], 0);
  ASSERT_EQ(message["events"].size(), 2u);
  EXPECT_EQ(message["events"][0]["number"], 4);
  EXPECT_EQ(message["events"][1]["text"], "event 5");
  EXPECT_EQ(pull(1), Json()) << "each of them once";
}

TEST_F(SubscriptionFeedsTest, MachinesAreRefusedBecauseChimeraWebKnowsThem) {
  const control::RpcResponse answer = feeds_.open(1, {{"to", "machines"}});
  EXPECT_EQ(answer.code, control::kRefused);
  EXPECT_EQ(answer.detail("kind"), "bench");
  EXPECT_EQ(answer.detail("remedy"), "ask the server of the page: `chimera web`");
}

TEST_F(SubscriptionFeedsTest, EventsComeFromANumberOn) {
  tell(3);
  open(1, {{"to", "events"}, {"since", 2}});
  EXPECT_EQ(pull(1)["events"][0]["number"], 2);
  open(2, {{"to", "events"}, {"since", 0}});
  EXPECT_EQ(pull(2)["events"].size(), 3u) << "there is no event 0";
}

TEST_F(SubscriptionFeedsTest, AtMostAThousandEventsComeAtOnceAndThoseThatAreGoneAreCounted) {
  tell(static_cast<int>(kEventsKept) + 5);
  open(1, {{"to", "events"}, {"since", 1}});
  Json message = pull(1);
  EXPECT_EQ(message["lost"], 5);
  EXPECT_EQ(message["events"].size(), kEventsAtOnce);
  EXPECT_EQ(message["events"][0]["number"], 6);
  for (std::size_t i = 1; i < kEventsKept / kEventsAtOnce; ++i) {
    message = pull(1);
    EXPECT_EQ(message["lost"], 0);
    EXPECT_EQ(message["events"][0]["number"], 6 + i * kEventsAtOnce);
  }
  EXPECT_EQ(message["events"].elements().back()["number"], kEventsKept + 5);
  EXPECT_EQ(pull(1), Json());
}

TEST_F(SubscriptionFeedsTest, EachSubscriptionHasItsOwnPlaceInTheLog) {
  open(1, {{"to", "events"}});
  open(2, {{"to", "events"}});
  tell(1);
  EXPECT_EQ(pull(1)["events"].size(), 1u);
  tell(1);
  EXPECT_EQ(pull(2)["events"].size(), 2u);
  feeds_.close(2);
  EXPECT_EQ(pull(1)["events"].size(), 1u);
}

TEST_F(SubscriptionFeedsTest, AStatusIsThePresentOne) {
  open(1, {{"to", "status"}});
  EXPECT_EQ(pull(1)["tasks"][2]["state"], "NOT-CREATED");
  state().rtpus[1].restarts = 2;
  EXPECT_EQ(pull(1)["rtpus"][1]["restarts"], 2) << "it always has something to say";
}

TEST_F(SubscriptionFeedsTest, ValuesAreThoseOfTheVariablesThatWereNamed) {
  open(1, {{"to", "values"}, {"variables", {"kp"}}});
  const Nanoseconds before = now();
  const Json message = pull(1);
  EXPECT_GE(message["at_ns"].as_int64(), before.count);
  ASSERT_EQ(message["values"].size(), 1u);
  EXPECT_EQ(message["values"]["kp"]["value"], (Json{1.0, 2.0}));
}

TEST_F(SubscriptionFeedsTest, RefusesAVariableThatDoesNotExist) {
  const control::RpcResponse answer = feeds_.open(1, {{"to", "values"}, {"variables", {"kq"}}});
  EXPECT_FALSE(answer.is_good());
  EXPECT_NE(answer.message.find("kq"), std::string::npos) << answer.message;
}

TEST_F(SubscriptionFeedsTest, TasksAreTappedWhileASubscriptionWantsThat) {
  open(1, {{"to", "tap"}, {"variables", {"x"}}});
  EXPECT_TRUE(is_tapped("sensor"));
  EXPECT_FALSE(is_tapped("law"));
  EXPECT_EQ(pull(1), Json()) << "nothing was published";
  open(2, {{"to", "tap"}, {"variables", {"x"}}});
  feeds_.close(1);
  EXPECT_TRUE(is_tapped("sensor"));
  feeds_.close(2);
  EXPECT_FALSE(is_tapped("sensor"));
}

}  // namespace
}  // namespace chimera::manager
