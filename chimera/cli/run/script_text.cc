// SPDX-License-Identifier: Apache-2.0
// Parses timed acts and finds the tasks and variables that they name.
#include "chimera/cli/run/script_text.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/task/signal.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

Error wrong_act(const std::string& text, const std::string& why) {
  return {ErrorCode::kBadInput, {"--at '" + text + "': " + why}, {}};
}

/// Index of the item of that name; `what` is the kind of item.
template <class Items>
Result<std::size_t> index_of(const Items& items, const char* what, const std::string& name, const std::string& text) {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (items[i].name == name) return i;
  return wrong_act(text, no_such(what, name, names_of(items, [](const auto& item) { return item.name; })));
}

Result<ScriptAct> parse_flag(const std::string& text, const std::string& which, ScriptAct act) {
  if (which != "up" && which != "down") return wrong_act(text, "write 'flag up' or 'flag down'");
  act.kind = which == "up" ? ScriptAct::Kind::kRaiseFlag : ScriptAct::Kind::kLowerFlag;
  return act;
}

Result<TaskId> task_named(const std::string& text, const std::string& name, const ApplicationSpec& spec) {
  const auto index = index_of(spec.tasks, "task", name, text);
  if (!index) return index.error();
  return TaskId(*index);
}

Result<ScriptAct> parse_signal(const std::string& text, const std::string& word, const std::string& task, ScriptAct act,
                               const ApplicationSpec& spec) {
  std::vector<std::string> words;
  for (int signal = 0; signal < CHIMERA_SIGNALS; ++signal) words.emplace_back(signal_name(static_cast<Signal>(signal)));
  words[static_cast<std::size_t>(Signal::kWakeup)] = "ring";  // sent as wakeup
  words.insert(words.end(), {"flag", "set", "switch", "die"});
  const auto signals = words.end() - 4;
  const auto found = std::find(words.begin(), signals, word);
  if (found == signals) return wrong_act(text, no_such("signal", word, words));
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
  const auto names = names_of(spec.tasks, &TaskSpec::name);
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
  return wrong_act(text, no_such("task", word, names));
}

Result<ScriptAct> parse_switch(const std::string& text, const std::string& name, ScriptAct act,
                               const ApplicationSpec& spec) {
  const auto index = index_of(spec.sets, "configuration", name, text);
  if (!index) return index.error();
  act.set = static_cast<std::uint32_t>(*index);
  return act;
}

Result<ScriptAct> parse_death(const std::string& text, const std::string& name, ScriptAct act,
                              const ApplicationSpec& spec) {
  act.kind = ScriptAct::Kind::kDie;
  const auto index = index_of(spec.rtpus, "rtpu", name, text);
  if (!index) return index.error();
  act.rtpu = RtpuId(*index);
  return act;
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
