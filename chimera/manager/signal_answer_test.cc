// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/signal_answer.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager {
namespace {

using control::Json;
using subsystem::CommandAnswer;
using subsystem::RefusalKind;

class SignalAnswerTest : public testing::Test {
 protected:
  void SetUp() override {
    fake_.start_manager();
    ASSERT_TRUE(fake_.until([&] { return fake_.driver().is_ready(); }));
  }
  /// "CODE MESSAGE DATA" of a refusal that names the task `law`.
  std::string refusal(RefusalKind kind, const char* reason, const char* remedy) {
    const CommandAnswer refused{1, {kind, reason, remedy}, fake_.task("law"), {}};
    const control::RpcResponse answer = signal_answer(fake_.driver().world(), refused);
    return std::to_string(answer.code) + " " + answer.message + " " + answer.data->dump();
  }
  FakeSubsystem fake_;
};

TEST_F(SignalAnswerTest, OfARefusalHasItsKindItsPlaceAndItsRemedyWhateverItsWordsAre) {
  EXPECT_EQ(refusal(RefusalKind::kState, "no answer from a parser", "type `chimera clear law`"),
            "-32000 no answer from a parser; type `chimera clear law` "
            R"({"kind":"state","remedy":"type `chimera clear law`","where":"law"})");
  EXPECT_EQ(refusal(RefusalKind::kFault, "the smallest legal set is: empty", ""),
            R"(-32000 the smallest legal set is: empty {"kind":"fault","where":"law"})");
}

TEST_F(SignalAnswerTest, OfAUnitThatDoesNotAnswerNamesTheUnit) {
  EXPECT_EQ(refusal(RefusalKind::kNoAnswer, "silence", ""),
            R"(-32006 silence {"rtpu":"spare","running":null})");
}

TEST_F(SignalAnswerTest, OfWhatWasDoneHasTheStatesOfEachTask) {
  const CommandAnswer done{1, {}, TaskId{}, {{fake_.task("law"), State::kOn, State::kOff, false},
                                             {fake_.task("filter"), State::kOff, State::kOff, true}}};
  const control::RpcResponse answer = signal_answer(fake_.driver().world(), done);
  ASSERT_TRUE(answer.is_good());
  EXPECT_EQ((*answer.result)["tasks"],
            Json::array({Json{{"task", "law"}, {"before", "ON"}, {"after", "OFF"}},
                         Json{{"task", "filter"}, {"before", "OFF"}, {"after", "OFF"}, {"already", true}}}));
}

}  // namespace
}  // namespace chimera::manager
