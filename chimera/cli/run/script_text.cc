// SPDX-License-Identifier: Apache-2.0
// Parses timed acts and finds the tasks and variables that they name.
#include "chimera/cli/run/script_text.h"

#include <algorithm>

#include "chimera/cli/files/blanks.h"
#include "chimera/task/signal.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

Error wrong_act(const std::string& text, const std::string& why) {
  return {ErrorCode::kBadInput, {"--at '" + text + "': " + why}, {}};
}

std::string unknown(const char* what, const std::string& found, std::span<const std::string> names) {
  const std::string near = nearest(found, names);
  return std::string("no ") + what + " '" + found + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?");
}

Result<ScriptAct> parse_flag(const std::string& text, const std::string& which, ScriptAct act) {
  if (which != "up" && which != "down") return wrong_act(text, "write 'flag up' or 'flag down'");
  act.kind = which == "up" ? ScriptAct::Kind::kRaiseFlag : ScriptAct::Kind::kLowerFlag;
  return act;
}

Result<TaskId> task_named(const std::string& text, const std::string& name, const ApplicationSpec& spec) {
  std::vector<std::string> names;
  for (const TaskSpec& t : spec.tasks) names.emplace_back(t.name);
  const TaskId task(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
  if (task.index < names.size()) return task;
  return wrong_act(text, unknown("task", name, names));
}

Result<ScriptAct> parse_signal(const std::string& text, const std::string& word, const std::string& task, ScriptAct act,
                               const ApplicationSpec& spec) {
  std::vector<std::string> words;
  for (int signal = 0; signal < CHIMERA_SIGNALS; ++signal) words.emplace_back(signal_name(static_cast<Signal>(signal)));
  words[static_cast<std::size_t>(Signal::kWakeup)] = "ring";  // sent as wakeup
  words.insert(words.end(), {"flag", "set", "switch", "die"});
  const auto signals = words.end() - 4;
  const auto found = std::find(words.begin(), signals, word);
  if (found == signals) return wrong_act(text, unknown("signal", word, words));
  act.signal = static_cast<Signal>(found - words.begin());
  const auto named = task_named(text, task, spec);
  if (!named) return named.error();
  act.task = *named;
  return act;
}

Result<TimedAct> parse_set(const std::string& text, const std::string& object, ScriptAct act) {
  const std::size_t blank = object.find(' ');
  if (blank == std::string::npos) return wrong_act(text, "write 'set VARIABLE VALUE', such as 'set kp 100 N.m/rad'");
  act.kind = ScriptAct::Kind::kSet;
  return TimedAct{act, text, object.substr(0, blank), trimmed(object.substr(blank)), {}};
}

// `lists`: "--on pid filter --off lqr".
Result<TimedAct> parse_lists(const std::string& text, const std::string& lists, ScriptAct act,
                             const ApplicationSpec& spec) {
  TimedAct made{act, text, {}, {}, {}};
  std::vector<std::string> names;
  for (const TaskSpec& t : spec.tasks) names.emplace_back(t.name);
  const auto find = [&names](std::string_view name) {
    const auto found = std::ranges::find(names, name);
    return found == names.end() ? TaskId{} : TaskId(static_cast<std::size_t>(found - names.begin()));
  };
  const ListsFault fault = read_lists(lists, find, made.lists);
  const std::string word(fault.word);
  switch (fault.kind) {
    case ListsFault::Kind::kNone: return made;
    case ListsFault::Kind::kEmpty:
      return wrong_act(text, "no task is named; write 'switch --on TASK... --off TASK...'");
    case ListsFault::Kind::kOutOfPlace:
      return wrong_act(text, "found '" + word + "'; write 'switch --on TASK... --off TASK...'");
    case ListsFault::Kind::kUnknownTask: break;
  }
  return wrong_act(text, unknown("task", word, names));
}

Result<ScriptAct> parse_switch(const std::string& text, const std::string& name, ScriptAct act,
                               const ApplicationSpec& spec) {
  std::vector<std::string> names;
  for (const NamedSet& set : spec.sets) names.emplace_back(set.name);
  act.set = static_cast<std::uint32_t>(std::find(names.begin(), names.end(), name) - names.begin());
  if (act.set < names.size()) return act;
  return wrong_act(text, unknown("configuration", name, names));
}

Result<ScriptAct> parse_death(const std::string& text, const std::string& name, ScriptAct act,
                              const ApplicationSpec& spec) {
  act.kind = ScriptAct::Kind::kDie;
  std::vector<std::string> names;
  for (const RtpuSpec& rtpu : spec.rtpus) names.emplace_back(rtpu.name);
  act.rtpu = RtpuId(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
  if (act.rtpu.index < names.size()) return act;
  return wrong_act(text, unknown("rtpu", name, names));
}

// At one instant deaths come first.
bool comes_before(const TimedAct& a, const TimedAct& b) noexcept {
  const auto is_death = [](const TimedAct& timed) { return timed.act.kind == ScriptAct::Kind::kDie; };
  return a.act.at != b.act.at ? a.act.at < b.act.at : is_death(a) && !is_death(b);
}

Result<TimedAct> parse(const std::string& text, const ApplicationSpec& spec) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return wrong_act(text, "write 'DURATION: SIGNAL TASK', such as '2 s: off pid'");
  const auto at = parse_duration(text.substr(0, colon));
  if (!at) return wrong_act(text, at.error().message.c_str());
  const std::string act_text = trimmed(text.substr(colon + 1));
  const std::size_t blank = act_text.find(' ');
  if (blank == std::string::npos)
    return wrong_act(text, "after the time stand a signal and a task, 'flag up', 'set VARIABLE VALUE', "
                           "'switch CONFIGURATION', 'switch --on TASK... --off TASK...', or 'die RTPU'");
  const std::string word = act_text.substr(0, blank);
  const std::string object = trimmed(act_text.substr(blank));
  ScriptAct act;
  act.at = *at;
  if (word == "switch") act.kind = ScriptAct::Kind::kSwitch;
  if (word == "set") return parse_set(text, object, act);
  if (word == "switch" && has_lists(object)) return parse_lists(text, object, act, spec);
  const auto made = word == "flag"     ? parse_flag(text, object, act)
                    : word == "switch" ? parse_switch(text, object, act, spec)
                    : word == "die"    ? parse_death(text, object, act, spec)
                                       : parse_signal(text, word, object, act, spec);
  return made ? Result<TimedAct>(TimedAct{*made, text, {}, {}, {}}) : Result<TimedAct>(made.error());
}

}  // namespace

Result<std::vector<TimedAct>> parse_script(std::span<const std::string> texts, const ApplicationSpec& spec) {
  std::vector<TimedAct> acts;
  for (const std::string& text : texts) {
    auto act = parse(text, spec);
    if (!act) return act.error();
    acts.push_back(*std::move(act));
  }
  std::stable_sort(acts.begin(), acts.end(), comes_before);
  return acts;
}

}  // namespace chimera::cli
