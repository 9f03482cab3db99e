// SPDX-License-Identifier: Apache-2.0
// Compares the table of state_machine.cc with a second one: the transitions of the papers and of state_machine.h. Each
// line has a signal in a state, the methods with their transfers and answers, and the final state.
#include "chimera/task/state_machine.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "chimera/base/hosted/wording.h"

namespace chimera {
namespace {

// One line for each story: state, signal, then per method `before|method=answer|after`, then the end.
// A leading ~ marks the aperiodic variant of a wakeup. "-" marks a method without transfers.
constexpr const char* kStories = R"(
NOT-CREATED spawn  >ic|init=ok|oc>  OFF
NOT-CREATED spawn  >ic|init=fault|- -|kill=ok|-  NOT-CREATED
NOT-CREATED spawn  >ic|init=fault|- -|kill=fault|-  NOT-CREATED
NOT-CREATED on      refused
NOT-CREATED off     refused
NOT-CREATED kill    refused
NOT-CREATED clear   refused
NOT-CREATED reinit  refused
NOT-CREATED wakeup  NOT-CREATED
OFF spawn  refused
OFF on  >iv>ov|on=ok|ov>  ON
OFF on  >iv>ov|on=not-yet|-  OFF
OFF on  >iv>ov|on=fault|- >iv|error=ok|ov>  OFF
OFF on  >iv>ov|on=fault|- >iv|error=fault|-  ERROR
OFF off    refused
OFF kill  -|kill=ok|-  NOT-CREATED
OFF kill  -|kill=fault|-  NOT-CREATED
OFF clear  refused
OFF reinit  >ic|reinit=ok|oc>  OFF
OFF reinit  >ic|reinit=fault|- >iv|error=ok|ov>  OFF
OFF reinit  >ic|reinit=fault|- >iv|error=fault|-  ERROR
OFF wakeup  OFF
ON spawn  refused
ON on     refused
ON off  >iv|off=ok|ov>  OFF
ON off  >iv|off=fault|- >iv|error=ok|ov>  OFF
ON off  >iv|off=fault|- >iv|error=fault|-  ERROR
ON kill  >iv|off=ok|ov> -|kill=ok|-  NOT-CREATED
ON kill  >iv|off=ok|ov> -|kill=fault|-  NOT-CREATED
ON kill  >iv|off=fault|- -|kill=ok|-  NOT-CREATED
ON kill  >iv|off=fault|- -|kill=fault|-  NOT-CREATED
ON clear  refused
ON reinit  >ic|reinit=ok|oc>  ON
ON reinit  >ic|reinit=fault|- >iv|error=ok|ov>  ON
ON reinit  >ic|reinit=fault|- >iv|error=fault|-  ERROR
ON wakeup  >iv|cycle=ok|ov>  ON
ON wakeup  >iv|cycle=aborted|-  ON
ON wakeup  >iv|cycle=fault|- >iv|error=ok|ov>  ON
ON wakeup  >iv|cycle=fault|- >iv|error=fault|-  ERROR
ON ~wakeup  -|sync=no-event|-  ON
ON ~wakeup  -|sync=fault|- >iv|error=ok|ov>  ON
ON ~wakeup  -|sync=fault|- >iv|error=fault|-  ERROR
ON ~wakeup  -|sync=ok|- >iv|cycle=ok|ov>  ON
ON ~wakeup  -|sync=ok|- >iv|cycle=aborted|-  ON
ON ~wakeup  -|sync=ok|- >iv|cycle=fault|- >iv|error=ok|ov>  ON
ON ~wakeup  -|sync=ok|- >iv|cycle=fault|- >iv|error=fault|-  ERROR
ERROR spawn  refused
ERROR on     refused
ERROR off    refused
ERROR kill  -|kill=ok|-  NOT-CREATED
ERROR kill  -|kill=fault|-  NOT-CREATED
ERROR clear  >iv|clear=ok|ov>  OFF
ERROR clear  >iv|clear=fault|-  ERROR
ERROR reinit  refused
ERROR wakeup  ERROR
)";

const char* text(Answer answer) {
  switch (answer) {
    case Answer::kOk: return "ok";
    case Answer::kFault: return "fault";
    case Answer::kNoEvent: return "no-event";
    case Answer::kAborted: return "aborted";
    case Answer::kNotYet: return "not-yet";
  }
  return "?";
}

std::string text(std::uint8_t transfers) {
  std::string out;
  if (transfers & kReadConst) out += ">ic";
  if (transfers & kReadIn) out += ">iv";
  if (transfers & kReadOut) out += ">ov";
  if (transfers & kWriteConst) out += "oc>";
  if (transfers & kWriteOut) out += "ov>";
  return out.empty() ? "-" : out;
}

// Follows every possible answer from `next` on and collects the stories.
void follow(const std::string& so_far, Next next, std::set<std::string>& stories) {
  if (next.kind == Next::Kind::kState) {
    stories.insert(so_far + " " + std::string(state_name(next.state)));
    return;
  }
  const StepRule& step = rule(next.step);
  for (int i = 0; i < kAnswers; ++i) {
    const auto answer = static_cast<Answer>(i);
    if (step.next[i].kind == Next::Kind::kImpossible) continue;
    const std::string after = answer == Answer::kOk ? text(step.after_ok) : "-";
    follow(so_far + " " + text(step.before) + "|" + std::string(method_name(step.method)) + "=" + text(answer) + "|" +
               after,
           step.next[i], stories);
  }
}

std::set<std::string> stories_of_the_code() {
  std::set<std::string> stories;
  for (int s = 0; s < kStates; ++s) {
    for (int g = 0; g < CHIMERA_SIGNALS; ++g) {
      const auto state = static_cast<State>(s);
      const auto signal = static_cast<Signal>(g);
      for (bool aperiodic : {false, true}) {
        const bool differs = state == State::kOn && signal == Signal::kWakeup;
        if (aperiodic && !differs) continue;
        const std::string head =
            std::string(state_name(state)) + " " + (aperiodic ? "~" : "") + std::string(signal_name(signal));
        const Next first = next(state, signal, aperiodic);
        if (first.kind == Next::Kind::kImpossible) stories.insert(head + " refused");
        else follow(head, first, stories);
      }
    }
  }
  return stories;
}

std::set<std::string> stories_of_the_papers() {
  std::set<std::string> stories;
  std::istringstream lines(kStories);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string story, word;
    while (words >> word) append_joined(story, " ", word);
    if (!story.empty()) stories.insert(story);
  }
  return stories;
}

TEST(StateMachine, FollowsTheStoriesOfThePapersExactly) {
  const auto code = stories_of_the_code();
  const auto papers = stories_of_the_papers();
  for (const auto& story : code) EXPECT_TRUE(papers.count(story)) << "only in the code:   " << story;
  for (const auto& story : papers) EXPECT_TRUE(code.count(story)) << "only in the papers: " << story;
}

TEST(StateMachine, AperiodicChangesNothingButTheWakeupOfATaskThatIsOn) {
  for (int s = 0; s < kStates; ++s)
    for (int g = 0; g < CHIMERA_SIGNALS; ++g) {
      const auto state = static_cast<State>(s);
      const auto signal = static_cast<Signal>(g);
      if (state == State::kOn && signal == Signal::kWakeup) continue;
      const Next a = next(state, signal, false), b = next(state, signal, true);
      EXPECT_EQ(std::tie(a.kind, a.step, a.state), std::tie(b.kind, b.step, b.state));
    }
}

TEST(StateMachine, TakesAnAnswerThatIsNotOneForAFault) {
  EXPECT_EQ(answer_of(Method::kCycle, CHIMERA_OK), Answer::kOk);
  EXPECT_EQ(answer_of(Method::kCycle, CHIMERA_ABORTED), Answer::kAborted);
  EXPECT_EQ(answer_of(Method::kCycle, CHIMERA_NO_EVENT), Answer::kFault);
  EXPECT_EQ(answer_of(Method::kOn, CHIMERA_NOT_YET), Answer::kNotYet);
  EXPECT_EQ(answer_of(Method::kCycle, CHIMERA_NOT_YET), Answer::kFault);
  EXPECT_EQ(answer_of(Method::kInit, CHIMERA_NOT_YET), Answer::kFault);
  EXPECT_EQ(answer_of(Method::kSync, CHIMERA_NO_EVENT), Answer::kNoEvent);
  EXPECT_EQ(answer_of(Method::kSync, CHIMERA_ABORTED), Answer::kFault);
  EXPECT_EQ(answer_of(Method::kOn, 77), Answer::kFault);
  EXPECT_EQ(answer_of(Method::kError, -1), Answer::kFault);
}

TEST(StateMachine, ASignalHasArrivedOnlyInItsTargetState) {
  struct {
    Signal signal;
    State before, after;
  } const arrived[] = {
      {Signal::kSpawn, State::kNotCreated, State::kOff}, {Signal::kOn, State::kOff, State::kOn},
      {Signal::kOff, State::kOn, State::kOff},           {Signal::kClear, State::kError, State::kOff},
      {Signal::kKill, State::kOn, State::kNotCreated},   {Signal::kKill, State::kOff, State::kNotCreated},
      {Signal::kReinit, State::kOn, State::kOn},         {Signal::kReinit, State::kOff, State::kOff}};
  for (const auto& story : arrived)
    for (int s = 0; s < kStates; ++s) {
      const auto after = static_cast<State>(s);
      EXPECT_EQ(has_arrived(story.signal, story.before, after), after == story.after)
          << signal_name(story.signal) << " ended in " << state_name(after);
    }
}

}  // namespace
}  // namespace chimera
