// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/script_text.h"

#include "chimera/cli/run/testing/test_application.h"

namespace chimera::cli {
namespace {

class ScriptText : public ::testing::Test {
 protected:
  Result<std::vector<TimedAct>> parse(const std::vector<std::string>& texts) {
    return parse_script(texts, application_.tasks().spec());
  }
  std::string refusal(const std::string& text) {
    const auto acts = parse({text});
    return acts ? "accepted" : std::string(acts.error().message.view());
  }
  Application application_ = test_application(kCounterText, test_library());
};

TEST_F(ScriptText, OrdersActsByTimeAndKeepsTheOrderOfOneInstant) {
  const auto acts = parse({"2 s: off counter", "500 ms: flag up", "2 s:   kill   counter", "0.6 s: flag down"});
  ASSERT_TRUE(acts);
  ASSERT_EQ(acts->size(), 4u);
  EXPECT_EQ((*acts)[0].act.kind, ScriptAct::Kind::kRaiseFlag);
  EXPECT_EQ((*acts)[0].act.at, milliseconds(500));
  EXPECT_EQ((*acts)[1].act.kind, ScriptAct::Kind::kLowerFlag);
  EXPECT_EQ((*acts)[2].act.signal, static_cast<Signal>(CHIMERA_SIGNAL_OFF));
  EXPECT_EQ((*acts)[3].act.signal, static_cast<Signal>(CHIMERA_SIGNAL_KILL));
  EXPECT_EQ((*acts)[3].act.task.index, 0u);
}

TEST_F(ScriptText, KnowsEverySignal) {
  const std::pair<const char*, int> words[] = {
      {"spawn", CHIMERA_SIGNAL_SPAWN}, {"on", CHIMERA_SIGNAL_ON},       {"off", CHIMERA_SIGNAL_OFF},
      {"kill", CHIMERA_SIGNAL_KILL},   {"clear", CHIMERA_SIGNAL_CLEAR}, {"reinit", CHIMERA_SIGNAL_REINIT},
      {"ring", CHIMERA_SIGNAL_WAKEUP}};
  for (const auto& [word, signal] : words) {
    const auto acts = parse({std::string("1 s: ") + word + " counter"});
    ASSERT_TRUE(acts) << word;
    EXPECT_EQ((*acts)[0].act.signal, static_cast<Signal>(signal)) << word;
  }
}

TEST_F(ScriptText, AValueIsEverythingBehindTheVariable) {
  const auto acts = parse({"3 s: set  kp   [1 2] N.m/rad ", "1 s: set vref 30 m/s"});
  ASSERT_TRUE(acts);
  EXPECT_EQ((*acts)[0].act.kind, ScriptAct::Kind::kSet);
  EXPECT_EQ((*acts)[0].act.at, seconds(1));
  EXPECT_EQ((*acts)[1].variable, "kp");
  EXPECT_EQ((*acts)[1].value, "[1 2] N.m/rad");
  EXPECT_EQ((*acts)[1].text, "3 s: set  kp   [1 2] N.m/rad ");
  EXPECT_EQ(refusal("1 s: set kp"), "--at '1 s: set kp': write 'set VARIABLE VALUE', such as 'set kp 100 N.m/rad'");
  EXPECT_EQ(refusal("1 s: sett kp 2"), "--at '1 s: sett kp 2': no signal 'sett'; did you mean 'set'?");
}

TEST_F(ScriptText, ADeathNamesAnRtpuAndComesFirstAtItsInstant) {
  const auto acts = parse({"2 s: off counter", "1 s: off counter", "2 s: die main"});
  ASSERT_TRUE(acts);
  EXPECT_EQ((*acts)[0].act.at, seconds(1));
  EXPECT_EQ((*acts)[1].act.kind, ScriptAct::Kind::kDie);
  EXPECT_EQ((*acts)[1].act.rtpu, RtpuId(0u));
  EXPECT_EQ((*acts)[2].act.kind, ScriptAct::Kind::kSignal);
  EXPECT_EQ(refusal("1 s: die mian"), "--at '1 s: die mian': no rtpu 'mian'; did you mean 'main'?");
}

TEST_F(ScriptText, ASwitchNamesAConfiguration) {
  const auto acts = parse({"3 s: switch all"});
  ASSERT_TRUE(acts);
  EXPECT_EQ((*acts)[0].act.kind, ScriptAct::Kind::kSwitch);
  EXPECT_EQ((*acts)[0].act.set, 0u);
  EXPECT_EQ(refusal("3 s: switch al"), "--at '3 s: switch al': no configuration 'al'; did you mean 'all'?");
  EXPECT_EQ(refusal("3 s: swich all"), "--at '3 s: swich all': no signal 'swich'; did you mean 'switch'?");
}

TEST_F(ScriptText, ASwitchNamesTasksInPlaceOfOne) {
  const auto acts = parse({"3 s: switch  --off counter", "4 s: switch --on counter --off counter --on counter"});
  ASSERT_TRUE(acts);
  EXPECT_EQ((*acts)[0].act.kind, ScriptAct::Kind::kSwitch);
  EXPECT_EQ((*acts)[0].act.set, UINT32_MAX);
  const TaskBits counter = bits_of(std::vector{TaskId(0u)});
  EXPECT_EQ((*acts)[0].lists, (TaskLists{{}, counter}));
  EXPECT_EQ((*acts)[1].lists, (TaskLists{counter, counter}));
  const std::string form = "write 'switch --on TASK... --off TASK...'";
  EXPECT_EQ(refusal("3 s: switch --on"), "--at '3 s: switch --on': no task is named; " + form);
  EXPECT_EQ(refusal("3 s: switch --of counter"), "--at '3 s: switch --of counter': found '--of'; " + form);
  EXPECT_EQ(refusal("3 s: switch -on counter"), "--at '3 s: switch -on counter': found '-on'; " + form);
  EXPECT_EQ(refusal("3 s: switch --on countr"),
            "--at '3 s: switch --on countr': no task 'countr'; did you mean 'counter'?");
}

TEST_F(ScriptText, RefusesTextThatIsNoAct) {
  const char* form = "write 'DURATION: SIGNAL TASK', such as '2 s: off pid'";
  const char* object = "after the time stand a signal and a task, 'flag up', 'set VARIABLE VALUE', "
                       "'switch CONFIGURATION', 'switch --on TASK... --off TASK...', or 'die RTPU'";
  EXPECT_EQ(refusal(""), std::string("--at '': ") + form);
  EXPECT_EQ(refusal("2 s off counter"), std::string("--at '2 s off counter': ") + form);
  EXPECT_EQ(refusal("2 s:"), std::string("--at '2 s:': ") + object);
  EXPECT_EQ(refusal("2 s:   "), std::string("--at '2 s:   ': ") + object);
  EXPECT_EQ(refusal("2 s: off"), std::string("--at '2 s: off': ") + object);
  EXPECT_EQ(refusal("2 s: off   "), std::string("--at '2 s: off   ': ") + object);
  EXPECT_EQ(refusal("1 s: flag sideways"), "--at '1 s: flag sideways': write 'flag up' or 'flag down'");
}

TEST_F(ScriptText, NamesTheNearestSignalAndTask) {
  EXPECT_EQ(refusal("1 s: offf counter"), "--at '1 s: offf counter': no signal 'offf'; did you mean 'off'?");
  EXPECT_EQ(refusal("1 s: off countr"), "--at '1 s: off countr': no task 'countr'; did you mean 'counter'?");
  EXPECT_EQ(refusal("1 s: off xyzzy_plugh"), "--at '1 s: off xyzzy_plugh': no task 'xyzzy_plugh'");
}

TEST_F(ScriptText, ABlankAfterTheNameIsNoPartOfIt) { EXPECT_EQ(refusal("1 s: off counter  "), "accepted"); }

TEST_F(ScriptText, RefusesInvalidTimes) {
  for (const char* time : {"", "2", "-1 s", "nan s", "1e400 s", "2 m", "1 s s"})
    EXPECT_EQ(refusal(std::string(time) + ": off counter").rfind(std::string("--at '") + time, 0), 0u) << time;
}

}  // namespace
}  // namespace chimera::cli
