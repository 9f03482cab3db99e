// SPDX-License-Identifier: Apache-2.0
// Answers of the manager to commands that an rtpu does not serve, and while everything ends.
#include <gtest/gtest.h>

#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager::answers_test {
namespace {

const std::string kTwo = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  slow: {component: t_thrower, rtpu: second, rate: 100 Hz, alias: {count: n}}
configurations: {all: [steady, slow]}
start: all
)";

TEST(SteppedAnswers, NameTheRtpuThatDoesNotAnswerAndItsMethod) {
  SteppedSubsystem system(kTwo);
  ASSERT_TRUE(system.until_started());
  system.stop("second", true);
  system.rtpu("second").segment.block.head().running = TaskWord(system.task("slow"), Method::kCycle).word();
  const control::RpcResponse answer =
      system.call("signal", {{"signal", "off"}, {"tasks", Json::array({"slow"})}});
  EXPECT_EQ(answer.code, control::kNoAnswer);
  EXPECT_EQ(answer.message, "no answer from rtpu second");
  EXPECT_EQ(answer.detail("rtpu"), "second");
  EXPECT_EQ(answer.detail("running"), "slow.cycle");
}

TEST(SteppedAnswers, RefuseSignalsWhileEverythingEnds) {
  SteppedSubsystem system(kTwo);
  ASSERT_TRUE(system.until_started());
  EXPECT_TRUE(system.call("end", {{"code", 3}}).is_good());
  ASSERT_TRUE(system.until([&] { return system.end_asked.has_value(); }));
  EXPECT_EQ(*system.end_asked, 3);
  system.page().ending = 1;  // by the keeper
  EXPECT_TRUE(system.status()["ending"].as_bool());
  const control::RpcResponse answer =
      system.call("signal", {{"signal", "on"}, {"tasks", Json::array({"steady"})}});
  EXPECT_EQ(answer.code, control::kEnding);
  EXPECT_EQ(answer.message, "the subsystem is ending");
}

}  // namespace
}  // namespace chimera::manager::answers_test
