// SPDX-License-Identifier: Apache-2.0
// Writes rows, each in one go.
#include "firmware/shell/shell_rows.h"

#include <cstring>
#include <iterator>

#include "chimera/runtime/plan/switch_words.h"

namespace chimera::firmware {
namespace {

template <class T>
T load(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// One number of a profile and its name.
struct Counter {
  const char* name;
  Count Profile::*count;
};

constexpr Counter kCounters[] = {{"cycles", &Profile::cycles},     {"missed", &Profile::missed},
                                 {"dropped", &Profile::dropped},   {"overrun", &Profile::overrun},
                                 {"aborted", &Profile::aborted},   {"held", &Profile::held},
                                 {"rejected", &Profile::rejected}, {"events lost", &Profile::events_lost}};

/// "missed 0 dropped 2 ", from number `first` on and before `end`.
void put_counters(TextLine& line, const Profile& profile, std::size_t first, std::size_t end) noexcept {
  for (std::size_t i = first; i < end; ++i)
    line.put("%z %l ", kCounters[i].name, static_cast<std::int64_t>(profile.*kCounters[i].count));
}

void put_name_and_state(TextLine& line, const Task& task) noexcept {
  line.put("%s %z ", task.spec->name, state_name(task.shown_state()));
}

void put_spread(TextLine& line, const char* what, const Spread& spread) noexcept {
  const Nanoseconds min = spread.min, max = spread.max;
  if (spread.count == 0) line.put("%z: none yet", what);
  else line.put("%z: %m to %m, mean %m", what, min, max, spread.mean());
}

std::string_view set_name(std::uint32_t set, const ApplicationSpec& spec) noexcept {
  return set < spec.sets.size() ? spec.sets[set].name : std::string_view("other tasks");
}

void put_task_number(TextLine& line, std::uint32_t task, std::span<const TaskSpec> tasks) noexcept {
  if (task < tasks.size()) line << tasks[task].name;
  else line.put("number %u", task);
}

}  // namespace

void put_end(TextLine& line, SwitchEnd end, NoSwitch why, TaskId task, const ApplicationSpec& spec) noexcept {
  line.put("%z", end_word(end));
  if (why != NoSwitch::kNone) line.put(", %z", reason_word(why));
  if (task.is_valid()) line.put(", task %s", spec.tasks[task.index].name);
}

void put_head(TextLine& line, TaskSet& set, Nanoseconds now) noexcept {
  const ApplicationSpec& spec = set.spec();
  std::uint32_t n_on = 0;
  for (const Task& task : set.tasks()) n_on += task.shown_state() == State::kOn ? 1 : 0;
  line.put("%s at %t: %u of %u tasks ON, flag %z", spec.name, now, n_on, set.tasks().size(),
           set.flag().is_up() ? "up" : "down");
  const std::uint32_t configuration = set.flag().configuration();
  if (configuration < spec.sets.size()) line.put(", configuration %s", spec.sets[configuration].name);
}

void put_task(TextLine& line, const Task& task) noexcept {
  put_name_and_state(line, task);
  put_counters(line, task.profile, 0, 3);
  line.put("faults %l", static_cast<std::int64_t>(task.faults.count));
}

bool put_profile(TextLine& line, const Task& task, std::size_t row, Nanoseconds origin) noexcept {
  const Profile& profile = task.profile;
  switch (row) {
    case 0:
      put_name_and_state(line, task);
      put_counters(line, profile, 0, 1);
      line.put("%zevery %m", task.spec->aperiodic ? "at most " : "", task.spec->period);
      return true;
    case 1: put_spread(line, "cycle", profile.execution[CHIMERA_CYCLE]); return true;
    case 2: put_spread(line, "response", profile.response); return true;
    case 3: put_spread(line, "start delay", profile.start_delay); return true;
    case 4:
      put_counters(line, profile, 1, std::size(kCounters));
      line.put("faults %l", static_cast<std::int64_t>(task.faults.count));
      return true;
    case 5:
      if (task.faults.count == 0) return false;
      line.put("the last at %t in %z", task.faults.at - origin, method_name(task.faults.method));
      if constexpr (mechanisms::kCopies) line.put(", code %d:", task.faults.last.code);
      return true;
    case 6:  // an image keeps the text of one task only; `events` has it
      if (!mechanisms::kCopies || task.faults.count == 0) return false;
      line.put("%z", task.faults.last.text);
      return true;
    default: return false;
  }
}

void put_event(TextLine& line, const ShellEvent& event, const ApplicationSpec& spec, Nanoseconds origin) noexcept {
  line.put("%t ", event.at - origin);
  if (event.kind == ShellEventKind::kSwitch) {
    line.put("switch from %s to %s: ", set_name(event.from, spec), set_name(event.to, spec));
    put_end(line, event.end, event.why, event.task, spec);
    line.put(", cycles lost: %u", event.lost);
    return;
  }
  line.put("%s: ", spec.tasks[event.task.index].name);
  if (event.kind == ShellEventKind::kState) {
    line.put("%z -> %z", state_name(event.before), state_name(event.after));
  } else if (event.kind == ShellEventKind::kFault) {
    line.put("fault in %z, code %d: %s", method_name(event.method), event.code, event.text.view());
    if (event.count > 1) line.put(" (%u times)", event.count);
  } else {
    line.put("deadlines missed");
    if (event.count > 0) line.put(": %u", event.count);  // 0: known from its cause alone
    if (event.other.is_valid()) line.put(", time used by %s", spec.tasks[event.other.index].name);
  }
}

void put_element(TextLine& line, std::uint32_t type, std::uint32_t bytes, const std::byte* at) noexcept {
  switch (type) {
    case CHIMERA_BOOL: line.put("%z", load<std::uint8_t>(at) != 0 ? "true" : "false"); break;
    case CHIMERA_INT32: line.put("%d", load<std::int32_t>(at)); break;
    case CHIMERA_INT64: line.put("%l", load<std::int64_t>(at)); break;
    case CHIMERA_FLOAT32: line.put("%g", static_cast<double>(load<float>(at))); break;
    case CHIMERA_FLOAT64: line.put("%g", load<double>(at)); break;
    default: {
      const char* const text = reinterpret_cast<const char*>(at);
      std::size_t n = 0;
      while (n < bytes && text[n] != '\0') ++n;
      line.put("'%s'", std::string_view(text, n));
      break;
    }
  }
}

void put_unit(TextLine& line, std::string_view unit) noexcept {
  if (unit != "1" && !unit.empty()) line.put(" %s", unit);
}

void put_vital(TextLine& line, const VitalAnswer& answer, std::span<const TaskSpec> tasks) noexcept {
  line.put("%z", vital_word(answer.fault));
  if (answer.is_healthy()) return;
  line.put(": ");
  if (answer.fault == VitalFault::kGuard) line.put("stack %u", answer.stack);
  else put_task_number(line, answer.task.index, tasks);
}

void put_boot(TextLine& line, const Boot& boot, std::span<const TaskSpec> tasks) noexcept {
  if (!boot.is_warm) {
    line.put("cold boot");
    return;
  }
  line.put("warm boot %u: %s", boot.warm_boots, cause_word(boot.cause));
  if (boot.running.method < CHIMERA_METHODS) {
    line.put(" in %z of task ", method_name(static_cast<Method>(boot.running.method)));
    put_task_number(line, boot.running.task, tasks);
  }
  if (boot.pc != 0) {
    line.put(" at 0x");
    for (int shift = 28; shift >= 0; shift -= 4) line << "0123456789abcdef"[boot.pc >> shift & 15u];
  }
  if (boot.vital != VitalFault::kNone) {
    line.put(", ");
    put_vital(line, {boot.vital, TaskId(boot.vital_number), boot.vital_number}, tasks);
  }
  if (boot.starts_off) line.put("; no task is started");
}

}  // namespace chimera::firmware
