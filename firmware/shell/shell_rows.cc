// SPDX-License-Identifier: Apache-2.0
// Writes rows, each in one go.
#include "firmware/shell/shell_rows.h"

#include <cstring>

#include "chimera/runtime/plan/switch_words.h"

namespace chimera::firmware {
namespace {

template <class T>
T load(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

void put_spread(TextLine& line, std::string_view what, const Spread& spread) noexcept {
  line << what << ": ";
  if (spread.count == 0) {
    line << "none yet";
    return;
  }
  line.put_us(spread.min) << " to ";
  line.put_us(spread.max) << ", mean ";
  line.put_us(spread.mean());
}

void put_set_name(TextLine& line, std::uint32_t set, const ApplicationSpec& spec) noexcept {
  if (set < spec.sets.size()) line << spec.sets[set].name;
  else line << "other tasks";
}

void put_switch(TextLine& line, const ShellEvent& event, const ApplicationSpec& spec) noexcept {
  line << "switch from ";
  put_set_name(line, event.from, spec);
  line << " to ";
  put_set_name(line, event.to, spec);
  line << ": " << end_word(event.end);
  if (event.why != NoSwitch::kNone) line << ", " << reason_word(event.why);
  if (event.task.is_valid()) line << ", task " << spec.tasks[event.task.index].name;
  if (event.end == SwitchEnd::kDone) line << ", " << event.lost << " cycles lost";
}

void put_hex(TextLine& line, std::uint32_t value) noexcept {
  line << "0x";
  for (int shift = 28; shift >= 0; shift -= 4) line << "0123456789abcdef"[value >> shift & 15u];
}

void put_task_number(TextLine& line, std::uint32_t task, std::span<const TaskSpec> tasks) noexcept {
  if (task < tasks.size()) line << tasks[task].name;
  else line << "number " << task;
}

}  // namespace

void put_head(TextLine& line, TaskSet& set, Nanoseconds now) noexcept {
  const ApplicationSpec& spec = set.spec();
  std::uint32_t n_on = 0;
  for (const Task& task : set.tasks()) n_on += task.shown_state() == State::kOn ? 1 : 0;
  line << spec.name << " at " << now << ": " << n_on << " of " << set.tasks().size() << " tasks ON, flag "
       << (set.flag().is_up() ? "up" : "down");
  const std::uint32_t configuration = set.flag().configuration();
  if (configuration < spec.sets.size()) line << ", configuration " << spec.sets[configuration].name;
}

void put_task(TextLine& line, const Task& task) noexcept {
  const Profile& profile = task.profile;
  line << task.spec->name << ' ' << state_name(task.shown_state()) << " cycles " << profile.cycles << " missed "
       << profile.missed << " dropped " << profile.dropped << " faults " << task.faults.count;
}

bool put_profile(TextLine& line, const Task& task, std::size_t row, Nanoseconds origin) noexcept {
  const Profile& profile = task.profile;
  switch (row) {
    case 0:
      line << task.spec->name << ' ' << state_name(task.shown_state()) << " cycles " << profile.cycles
           << (task.spec->aperiodic ? " at most every " : " every ");
      line.put_us(task.spec->period);
      return true;
    case 1: put_spread(line, "cycle", profile.execution[CHIMERA_CYCLE]); return true;
    case 2: put_spread(line, "response", profile.response); return true;
    case 3: put_spread(line, "start delay", profile.start_delay); return true;
    case 4:
      line << "missed " << profile.missed << " dropped " << profile.dropped << " overrun " << profile.overrun
           << " aborted " << profile.aborted << " held " << profile.held << " rejected " << profile.rejected
           << " events lost " << profile.events_lost;
      return true;
    case 5:
      line << "faults " << task.faults.count;
      if (task.faults.count != 0)
        line << ", the last at " << task.faults.at - origin << " in " << method_name(task.faults.method) << ", code "
             << task.faults.last.code << ':';
      return true;
    case 6:
      if (task.faults.count != 0) line << task.faults.last.text;
      return task.faults.count != 0;
    default: return false;
  }
}

void put_event(TextLine& line, const ShellEvent& event, const ApplicationSpec& spec, Nanoseconds origin) noexcept {
  line << event.at - origin << ' ';
  if (event.kind == ShellEventKind::kSwitch) return put_switch(line, event, spec);
  line << spec.tasks[event.task.index].name << ": ";
  switch (event.kind) {
    case ShellEventKind::kState: line << state_name(event.before) << " -> " << state_name(event.after); break;
    case ShellEventKind::kMissed:
      if (event.count > 0) line << event.count << ' ';  // 0: known from its cause alone
      line << (event.count == 1 ? "deadline missed" : "deadlines missed");
      if (event.other.is_valid()) line << ", time used by " << spec.tasks[event.other.index].name;
      break;
    default:
      line << "fault in " << method_name(event.method) << ", code " << event.code << ": " << event.text.view();
      if (event.count > 1) line << " (" << event.count << " times)";
      break;
  }
}

void put_element(TextLine& line, std::uint32_t type, std::uint32_t bytes, const std::byte* at) noexcept {
  switch (type) {
    case CHIMERA_BOOL: line << (load<std::uint8_t>(at) != 0 ? "true" : "false"); break;
    case CHIMERA_INT32: line << load<std::int32_t>(at); break;
    case CHIMERA_INT64: line << load<std::int64_t>(at); break;
    case CHIMERA_FLOAT32: line << static_cast<double>(load<float>(at)); break;
    case CHIMERA_FLOAT64: line << load<double>(at); break;
    default: {
      const char* const text = reinterpret_cast<const char*>(at);
      std::size_t n = 0;
      while (n < bytes && text[n] != '\0') ++n;
      line << '\'' << std::string_view(text, n) << '\'';
      break;
    }
  }
}

void put_unit(TextLine& line, std::string_view unit) noexcept {
  if (unit != "1" && !unit.empty()) line << ' ' << unit;
}

void put_vital(TextLine& line, const VitalAnswer& answer, std::span<const TaskSpec> tasks) noexcept {
  line << vital_word(answer.fault);
  if (answer.is_healthy()) return;
  line << ": ";
  if (answer.fault == VitalFault::kGuard) line << "stack " << answer.stack;
  else put_task_number(line, answer.task.index, tasks);
}

void put_boot(TextLine& line, const Boot& boot, std::span<const TaskSpec> tasks) noexcept {
  if (!boot.is_warm) {
    line << "cold boot";
    return;
  }
  line << "warm boot " << boot.warm_boots << ": " << cause_word(boot.cause);
  if (boot.running.method < CHIMERA_METHODS) {
    line << " in " << method_name(static_cast<Method>(boot.running.method)) << " of task ";
    put_task_number(line, boot.running.task, tasks);
  }
  if (boot.pc != 0) {
    line << " at ";
    put_hex(line, boot.pc);
  }
  if (boot.vital != VitalFault::kNone) {
    line << ", ";
    put_vital(line, {boot.vital, TaskId(boot.vital_number), boot.vital_number}, tasks);
  }
  if (boot.starts_off) line << "; everything starts OFF";
}

}  // namespace chimera::firmware
