// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/remedy.h"

#include <gtest/gtest.h>

#include <sstream>

#include "chimera/subsystem/testing/test_parts.h"

namespace chimera::subsystem {
namespace {

constexpr State kAll[] = {State::kNotCreated, State::kOff, State::kOn, State::kError};

class RemedyTest : public ::testing::Test, public TestParts {
 protected:
  std::string of(Signal signal, State arm, State pid) {
    is(kArm, arm);
    is(kPid, pid);
    const TaskId both[] = {kArm, kPid};
    return remedy(state, signal, both);
  }

  /// Carries out the commands of a remedy, each of which must be legal for every task that it names.
  void carry_out(const std::string& text) {
    std::istringstream words(text);
    Signal signal{};
    for (std::string word; words >> word;) {
      if (word == "then" || word == "`chimera") continue;
      const std::string name = word.substr(0, word.find_first_of("`,"));
      if (const auto found = signal_named(name)) {
        signal = *found;
        continue;
      }
      const TaskId task = name == "arm" ? kArm : kPid;
      const State before = state.observed.state(task);
      EXPECT_TRUE(is_legal(before, signal)) << name << " in " << state_name(before) << ": " << text;
      is(task, signal == Signal::kKill     ? State::kNotCreated
               : signal == Signal::kOn     ? State::kOn
               : signal == Signal::kReinit ? before
                                           : State::kOff);
    }
  }
  static std::optional<Signal> signal_named(const std::string& name) {
    for (const Signal signal :
         {Signal::kSpawn, Signal::kOn, Signal::kOff, Signal::kKill, Signal::kClear, Signal::kReinit})
      if (name == signal_name(signal)) return signal;
    return std::nullopt;
  }
};

TEST_F(RemedyTest, ASignalWithoutEffectHasNoRemedy) {
  EXPECT_EQ(of(Signal::kOn, State::kOn, State::kOn), "");
  EXPECT_EQ(of(Signal::kOff, State::kOff, State::kOff), "");
  EXPECT_EQ(of(Signal::kSpawn, State::kOff, State::kOn), "");
}

TEST_F(RemedyTest, NamesThoseTasksOnlyThatAreNotThereYet) {
  EXPECT_EQ(of(Signal::kOn, State::kOn, State::kError), "`chimera clear pid`, then `chimera on pid`");
  EXPECT_EQ(of(Signal::kOn, State::kNotCreated, State::kOff), "`chimera spawn arm`, then `chimera on arm pid`");
  EXPECT_EQ(of(Signal::kOff, State::kOff, State::kNotCreated), "");
  EXPECT_EQ(of(Signal::kOff, State::kOn, State::kNotCreated), "`chimera off arm`");
  EXPECT_EQ(of(Signal::kReinit, State::kOn, State::kError), "`chimera clear pid`, then `chimera reinit arm pid`");
}

TEST_F(RemedyTest, EveryRemedyIsLegalAndReachesTheState) {
  for (const Signal signal :
       {Signal::kSpawn, Signal::kOn, Signal::kOff, Signal::kKill, Signal::kClear, Signal::kReinit})
    for (const State arm : kAll)
      for (const State pid : kAll) {
        SCOPED_TRACE(std::string(signal_name(signal)) + " " + state_name(arm) + " " + state_name(pid));
        carry_out(of(signal, arm, pid));
        const State after = state.observed.state(kArm);
        const bool only_from_there = signal == Signal::kSpawn || signal == Signal::kClear || signal == Signal::kOff;
        const State arrived = signal == Signal::kOn                            ? State::kOn
                              : signal == Signal::kKill                        ? State::kNotCreated
                              : signal == Signal::kReinit && arm == State::kOn ? State::kOn
                                                                               : State::kOff;
        EXPECT_TRUE(after == arrived || (only_from_there && after == arm)) << state_name(after);
        EXPECT_FALSE(of(signal, after, state.observed.state(kPid)).starts_with("`chimera spawn"))
            << "carried out once more it has nothing to spawn";
      }
}

}  // namespace
}  // namespace chimera::subsystem
