// SPDX-License-Identifier: Apache-2.0
// Puts the receipt of a switch into words and into JSON.
#include "chimera/control/receipt_text.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "chimera/text/json_text.h"
#include "chimera/text/time_text.h"

namespace chimera::control {
namespace {

std::string quoted(std::string_view name) { return "'" + std::string(name) + "'"; }

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string at(Nanoseconds instant, Nanoseconds origin) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f s", to_seconds(instant - origin));
  return text;
}

const char* word(SwitchEnd end) {
  switch (end) {
    case SwitchEnd::kDone: return "done";
    case SwitchEnd::kAborted: return "aborted";
    case SwitchEnd::kRefused: return "refused";
    case SwitchEnd::kNothingToDo: return "nothing-to-do";
  }
  return "?";
}

/// "switch 3", "takeover 4".
std::string what(const SwitchReceipt& receipt) {
  return (receipt.cause == SwitchCause::kStandby ? "takeover " : "switch ") + std::to_string(receipt.number);
}

const char* word(TaskMove move) {
  switch (move) {
    case TaskMove::kArrives: return "arrives";
    case TaskMove::kLeaves: return "leaves";
    case TaskMove::kStays: return "stays";
  }
  return "?";
}

/// The port of that kind; null: there is none.
const PortSpec* find_port(const PortOf& of, int kind, const ApplicationSpec& spec) {
  std::uint32_t n = 0;
  for (const PortSpec& port : spec.tasks[of.task.index].ports)
    if (port.kind == static_cast<std::uint32_t>(kind) && n++ == of.index) return &port;
  return nullptr;
}

/// Of a task that produces the variable, else of one that reads it.
const PortSpec* port_of(const Variable& variable, const ApplicationSpec& spec) {
  if (!variable.producers.empty()) return find_port(variable.producers[0], CHIMERA_OUT_VAR, spec);
  return variable.consumers.empty() ? nullptr : find_port(variable.consumers[0], CHIMERA_IN_VAR, spec);
}

std::string unit_of(const VariablePart& part, const ApplicationSpec& spec) {
  const PortSpec* const port = find_port(part.handover.to, CHIMERA_OUT_VAR, spec);
  return port == nullptr ? "1" : std::string(port->unit);
}

/// Behind a number.
std::string unit_text(const std::string& unit) { return unit == "1" ? "" : " " + unit; }
std::string unit_text(const VariablePart& part, const ApplicationSpec& spec) { return unit_text(unit_of(part, spec)); }

std::string step_text(const ValueStep& step, const std::string& unit) {
  return number(step.size) + unit + (step.limit > 0 ? ", limit " + number(step.limit) + unit : "");
}

std::string json_asked_by(const SwitchReceipt& receipt, const ApplicationSpec& spec, const std::string& person) {
  const std::size_t colon = person.find(':');
  if (receipt.cause == SwitchCause::kScript && colon != std::string::npos)
    return "{\"role\": " + json_string(person.substr(0, colon)) + ", \"user\": " +
           json_string(person.substr(colon + 1)) + "}";
  if (receipt.cause == SwitchCause::kScript) return "{\"script\": \"--at\"}";
  const std::string task = "\"task\": " + json_string(std::string(spec.tasks[receipt.by.index].name)) + "}";
  if (receipt.cause == SwitchCause::kRequest) return "{" + task;
  if (receipt.cause == SwitchCause::kStandby)
    return "{\"reaction\": \"standby_for\", \"lost\": " +
           json_string(std::string(spec.tasks[receipt.in_place_of.index].name)) + ", \"by\": " +
           (receipt.was_death ? "\"death\", " : "\"error\", ") + task;
  const std::string by = asked_by(SwitchRequest{receipt.after, receipt.cause, receipt.by}, spec);
  return "{\"reaction\": " + json_string(by.substr(0, by.find(' '))) + ", " + task;
}

/// "'speed' is 3 rad/s, and safe_when of 'hand' asks for speed < 0.1 rad/s".
std::string unsafe_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const SafeCondition& asked = asked_of(spec, receipt.after);
  if (!asked.is_there() || receipt.variable != asked.variable) return reason_word(receipt.why);
  const PortSpec* const port = port_of(spec.variables[asked.variable.index], spec);
  const std::string unit = port == nullptr ? "" : unit_text(std::string(port->unit));
  std::string name(spec.variables[asked.variable.index].name);
  if (port != nullptr && port->max_count() > 1) name += "[" + std::to_string(asked.element) + "]";
  const std::string is = std::isnan(receipt.value) ? " has no value" : " is " + number(receipt.value) + unit;
  return "'" + name + "'" + is + ", and safe_when of " + set_text(receipt.after, spec) + " asks for " + name + " " +
         sign_of(asked.comparison) + " " + number(asked.limit) + unit;
}

std::size_t count(const SwitchReceipt& receipt, TaskMove move) {
  std::size_t n = 0;
  for (const TaskPart& part : receipt.tasks) n += part.move == move ? 1 : 0;
  return n;
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// What readers saw first: the first cycle of the producer after, else what its `on` wrote.
const ValueStep& seen(const VariablePart& part) {
  return part.step_of_cycle.is_known ? part.step_of_cycle : part.step_of_on;
}

std::string names(std::span<const TaskId> tasks, const ApplicationSpec& spec) {
  std::string text;
  for (const TaskId task : tasks) text += (text.empty() ? "" : ", ") + std::string(spec.tasks[task.index].name);
  return text;
}

std::string after_text(const SwitchReceipt& receipt) {
  char took[40];
  std::snprintf(took, sizeof took, " after %.3f ms", to_seconds(receipt.at - receipt.asked) * 1e3);
  return took;
}

std::string moves_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  std::string text;
  for (const VariablePart& part : receipt.variables)
    if (seen(part).is_known)
      text += "; " + std::string(spec.variables[part.handover.variable.index].name) + " moves by " +
              step_text(seen(part), unit_text(part, spec));
  return text;
}

std::string done_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const bool is_slow = receipt.way.slow != 0;
  const std::string under = is_slow ? ", " + time_text(receipt.flag) + " under the flag" : "";
  std::uint64_t lost = 0;
  for (const TaskPart& part : receipt.tasks) lost += part.lost;
  std::string text = after_text(receipt) + under + ": " +
                     counted(count(receipt, TaskMove::kArrives), "task arrives", "tasks arrive") + ", " +
                     counted(count(receipt, TaskMove::kLeaves), "leaves", "leave") + ", " +
                     counted(lost, "cycle lost", "cycles lost");
  if (!receipt.reinitialised.empty()) text += "; " + names(receipt.reinitialised, spec) + " re-initialised";
  return text + moves_text(receipt, spec) + "\n";
}

std::string bumps(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  std::string text;
  for (const std::string& line : bump_lines(receipt, spec)) text += line + "\n";
  return text;
}

std::string takeover_text(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin) {
  const auto name = [&](TaskId task) { return quoted(spec.tasks[task.index].name); };
  const std::string text = what(receipt) + " at " + at(receipt.asked, origin) + " by " + name(receipt.by) + " from " +
                           name(receipt.in_place_of) +
                           (receipt.was_death ? ", whose real-time unit died," : ", which is in ERROR,");
  if (receipt.end != SwitchEnd::kDone) return text + " aborted: " + reason_text(receipt, spec) + "\n";
  std::uint64_t lost = 0;
  for (const TaskPart& part : receipt.tasks) lost += part.lost;
  const std::string flag =
      receipt.flag > Nanoseconds{} ? ", " + time_text(receipt.flag) + " under the flag" : std::string();
  return text + after_text(receipt) + flag + ": " + counted(lost, "cycle lost", "cycles lost") +
         moves_text(receipt, spec) + "\n" + bumps(receipt, spec);
}

std::string json_ns(std::optional<Nanoseconds> time) { return time ? std::to_string(time->count) : "null"; }

std::string json_instant(Nanoseconds instant, Nanoseconds origin) {
  return instant == kNever ? "null" : std::to_string((instant - origin).count);
}

std::string json_number(bool is_known, double value) {
  if (!is_known || !std::isfinite(value)) return "null";
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string json_name(bool is_there, std::string_view name) {
  return is_there ? json_string(std::string(name)) : "null";
}

std::string json_of(const TaskPart& part, const ApplicationSpec& spec) {
  const auto time = [](Nanoseconds ns) { return ns < Nanoseconds{} ? std::nullopt : std::optional(ns); };
  return "{\"task\": " + json_string(std::string(spec.tasks[part.task.index].name)) + ", \"move\": \"" +
         word(part.move) + "\", \"on_ns\": " + json_ns(time(part.on)) + ", \"off_ns\": " + json_ns(time(part.off)) +
         ", \"lost\": " + std::to_string(part.lost) + ", \"delay_ns\": " + json_ns(time(part.delay)) +
         ", \"delay_before_ns\": " + json_ns(time(part.delay_before)) + "}";
}

std::string json_of(const VariablePart& part, const ApplicationSpec& spec) {
  const Handover& h = part.handover;
  const ValueStep& step = seen(part);
  const bool has_from = h.from.task.is_valid();
  return "{\"variable\": " + json_string(std::string(spec.variables[h.variable.index].name)) + ", \"from\": " +
         json_name(has_from, has_from ? spec.tasks[h.from.task.index].name : "") + ", \"to\": " +
         json_string(std::string(spec.tasks[h.to.task.index].name)) + ", \"step_of_on\": " +
         json_number(part.step_of_on.is_known, part.step_of_on.size) + ", \"step\": " +
         json_number(step.is_known, step.size) + ", \"usual_step\": " +
         json_number(part.usual.is_known, part.usual.size) + ", \"unit\": " + json_string(unit_of(part, spec)) +
         ", \"limit\": " + json_number(step.limit > 0, step.limit) +
         ", \"beyond\": " + (step.is_beyond ? "true" : "false") + "}";
}

/// How long each phase took; null: it was not gone through.
std::string json_durations(const SwitchReceipt& receipt) {
  const auto between = [](Nanoseconds from, Nanoseconds to) {
    return from == kNever || to == kNever ? "null" : std::to_string((to - from).count);
  };
  return "{\"arming\": " + between(receipt.asked, receipt.armed) + ", \"agreeing\": " +
         between(receipt.armed, receipt.at) + ", \"ending\": " + between(receipt.at, receipt.ended) + "}";
}

template <class Parts>
std::string json_list(const Parts& parts, const ApplicationSpec& spec) {
  std::string json;
  for (const auto& part : parts) json += (json.empty() ? "" : ", ") + json_of(part, spec);
  return "[" + json + "]";
}

/// Who would miss what, and where to see more.
std::string not_schedulable(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const TaskId late = receipt.way.deadline.task;
  if (!late.is_valid()) return reason_word(NoSwitch::kNotSchedulable);
  const TaskSpec& task = spec.tasks[late.index];
  const std::string from = receipt.before == kNoSet ? "what is ON" : quoted(spec.sets[receipt.before].name);
  const Nanoseconds takes = receipt.way.deadline.takes;
  return "the transition from " + from + " to " + set_text(receipt.after, spec) +
         " is not schedulable on CPU " + std::to_string(spec.rtpus[task.rtpu.index].cpu) + ": a cycle of task " +
         quoted(task.name) + " may take " +
         (takes == kNever ? "longer than its deadline of " + time_text(task.deadline)
                          : time_text(takes) + ", its deadline is " + time_text(task.deadline));
}

std::string absent_text(const SwitchWay& way, const ApplicationSpec& spec) {
  if (!way.absent.is_valid()) return "an arriving task has the resource of another one";
  const std::string text = "task " + quoted(spec.tasks[way.absent.index].name) + " is NOT-CREATED";
  if (!way.rival.is_valid()) return text;
  return text + ": task " + quoted(spec.tasks[way.rival.index].name) + " has its resource";
}

/// Behind a line of the text, of a slow switch.
std::string rolled_back(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  if (receipt.way.slow == 0 || receipt.end != SwitchEnd::kAborted || receipt.flag == Nanoseconds{}) return "";
  std::string text = "; rolled back, " + time_text(receipt.flag) + " under the flag";
  if (receipt.not_back.is_valid())
    text += "; task " + quoted(spec.tasks[receipt.not_back.index].name) + " did not come back";
  return text;
}

std::string json_way(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const bool is_slow = receipt.way.slow != 0;
  std::string reasons, list;
  for (const std::string& word : slow_words(receipt.way)) reasons += (reasons.empty() ? "\"" : ", \"") + word + "\"";
  for (const TaskId task : receipt.reinitialised)
    list += (list.empty() ? "" : ", ") + json_string(std::string(spec.tasks[task.index].name));
  const bool is_back = !receipt.not_back.is_valid();
  const char* const way = receipt.cause == SwitchCause::kStandby ? "takeover" : is_slow ? "slow" : "fast";
  return std::string("\"way\": \"") + way + "\", \"slow_because\": [" + reasons +
         "], \"slow_why\": " + json_name(is_slow, slow_text(receipt, spec)) + ", \"flag_ns\": " +
         std::to_string(receipt.flag.count) + ", \"reinitialised\": [" + list + "], \"not_back\": " +
         json_name(!is_back, is_back ? "" : spec.tasks[receipt.not_back.index].name);
}

}  // namespace

std::string set_text(std::uint32_t set, const ApplicationSpec& spec) {
  return set == kNoSet ? "other tasks" : quoted(spec.sets[set].name);
}

std::vector<std::string> slow_words(const SwitchWay& way) {
  std::vector<std::string> words;
  if ((way.slow & kSlowForConstants) != 0) words.emplace_back("constants");
  if ((way.slow & kSlowForGap) != 0) words.emplace_back("no-gap");
  if ((way.slow & kSlowForDeadlines) != 0) words.emplace_back("not-schedulable");
  if ((way.slow & kSlowForResource) != 0) words.emplace_back("resource");
  if ((way.slow & kSlowForDevice) != 0) words.emplace_back("not-ready");
  return words;
}

std::string slow_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const SwitchWay& way = receipt.way;
  std::string text;
  const auto add = [&text](const std::string& why) { text += (text.empty() ? "" : "; ") + why; };
  if ((way.slow & kSlowForConstants) != 0 && way.constant.task.is_valid())
    add("constant " + quoted(spec.constants[way.constant.constant.index].name) + " of task " +
        quoted(spec.tasks[way.constant.task.index].name) + ", which stays, changes");
  if ((way.slow & kSlowForGap) != 0) add("on of an arriving task fits no gap");
  if ((way.slow & kSlowForDeadlines) != 0) add(not_schedulable(receipt, spec));
  if ((way.slow & kSlowForResource) != 0) add(absent_text(way, spec));
  if ((way.slow & kSlowForDevice) != 0) add("on of an arriving task was not ready at once");
  return text;
}

std::string asked_by(const SwitchRequest& request, const ApplicationSpec& spec) {
  const std::string name = request.by.is_valid() ? std::string(spec.tasks[request.by.index].name) : "";
  switch (request.cause) {
    case SwitchCause::kScript: return "--at";
    case SwitchCause::kRequest: return "task " + name;
    case SwitchCause::kMiss: return "on_miss of " + name;
    case SwitchCause::kOverrun: return "on_overrun of " + name;
    case SwitchCause::kFault: return "on_fault of " + name;
    case SwitchCause::kStandby: return "standby_for of " + name;
  }
  return "?";
}

const char* reason_word(NoSwitch why) noexcept {
  switch (why) {
    case NoSwitch::kNone: return "none";
    case NoSwitch::kUnknownSet: return "unknown-configuration";
    case NoSwitch::kNothingToDo: return "nothing-to-do";
    case NoSwitch::kInError: return "in-error";
    case NoSwitch::kNotCreated: return "not-created";
    case NoSwitch::kUnderWay: return "under-way";
    case NoSwitch::kNotSchedulable: return "not-schedulable";
    case NoSwitch::kOnFailed: return "on-failed";
    case NoSwitch::kStepTooLarge: return "step-too-large";
    case NoSwitch::kNoGap: return "no-gap";
    case NoSwitch::kNoValue: return "no-value";
    case NoSwitch::kNotSafe: return "not-safe";
    case NoSwitch::kDisturbed: return "disturbed";
    case NoSwitch::kFlagRaised: return "flag-raised";
    case NoSwitch::kRunEnded: return "run-ended";
    case NoSwitch::kLate: return "late";
    case NoSwitch::kMemberDied: return "member-died";
    case NoSwitch::kDamaged: return "damaged";
    case NoSwitch::kCancelled: return "cancelled";
    case NoSwitch::kBadConstant: return "bad-constant";
    case NoSwitch::kStepFailed: return "step-failed";
    case NoSwitch::kNotReady: return "not-ready";
  }
  return "?";
}

std::string reason_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const std::string task = receipt.task.is_valid() ? quoted(spec.tasks[receipt.task.index].name) : "";
  const std::string variable = receipt.variable.is_valid() ? quoted(spec.variables[receipt.variable.index].name) : "";
  switch (receipt.why) {
    case NoSwitch::kInError: return "task " + task + " is in ERROR: clear it first";
    case NoSwitch::kNotCreated: return "task " + task + " is not there: spawn it first";
    case NoSwitch::kUnderWay:
      return receipt.said.view().empty() ? "another switch is under way" : std::string(receipt.said.view());
    case NoSwitch::kOnFailed: return "on of task " + task + ": " + std::string(receipt.said.view());
    case NoSwitch::kStepTooLarge: {
      std::string text = "on of task " + task + " would move " + variable + " too far";
      for (const VariablePart& part : receipt.variables)
        if (part.handover.variable == receipt.variable)
          text += ": by " + step_text(part.step_of_on, unit_text(part, spec));
      return text;
    }
    case NoSwitch::kNoGap:
      return task.empty() ? "the processor was never idle for 10 s"
                          : "the processor was never idle for as long as on of task " + task + " takes, for 10 s";
    case NoSwitch::kNoValue: return "task " + task + " waited 10 s for a value of " + variable;
    case NoSwitch::kNotSafe: return unsafe_text(receipt, spec);
    case NoSwitch::kDisturbed: return "task " + task + " went to another state meanwhile";
    case NoSwitch::kFlagRaised: return "the illegal-configuration flag was raised meanwhile";
    case NoSwitch::kRunEnded: return "the run ended";
    case NoSwitch::kLate: return "a real-time unit was too late to agree to the instant of the change";
    case NoSwitch::kMemberDied: return "a real-time unit died";
    case NoSwitch::kDamaged: return "the order on the decision page is not what the manager wrote";
    case NoSwitch::kCancelled: {
      const std::string by(receipt.said.view());
      return by.empty() ? "cancelled" : "cancelled by " + by;
    }
    case NoSwitch::kBadConstant:
      return "task " + task + " cannot be initialised with the constants of " + quoted(spec.sets[receipt.after].name) +
             ": " + std::string(receipt.said.view());
    case NoSwitch::kStepFailed: return "a method of task " + task + " failed: " + std::string(receipt.said.view());
    case NoSwitch::kNotReady:
      return task.empty() ? "a real-time unit was not ready for 10 s" : "task " + task + " was not ready for 10 s";
    default: return reason_word(receipt.why);
  }
}

std::vector<std::string> bump_lines(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  std::vector<std::string> lines;
  const bool is_takeover = receipt.cause == SwitchCause::kStandby;  // whose `on` is not held against its limit before
  for (const VariablePart& part : receipt.variables) {
    const ValueStep& step = is_takeover ? seen(part) : part.step_of_cycle;
    if (!step.is_beyond) continue;
    const std::string task = quoted(spec.tasks[part.handover.to.task.index].name);
    const std::string variable = quoted(spec.variables[part.handover.variable.index].name);
    lines.push_back("bump: after " + what(receipt) + " the first " + (part.step_of_cycle.is_known ? "cycle" : "value") +
                    " of task " + task + " moved " + variable + " by " + step_text(step, unit_text(part, spec)));
  }
  return lines;
}

std::string receipt_text(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin) {
  if (receipt.cause == SwitchCause::kStandby) return takeover_text(receipt, spec, origin);
  const std::string to = set_text(receipt.after, spec);
  const std::string when = " at " + at(receipt.asked, origin);
  if (receipt.end == SwitchEnd::kNothingToDo) return "switch" + when + ": " + to + " is in force, nothing to do\n";
  const std::string from = receipt.before == kNoSet ? "" : "from " + quoted(spec.sets[receipt.before].name) + " ";
  const SwitchRequest request{receipt.after, receipt.cause, receipt.by};
  const std::string by = receipt.cause == SwitchCause::kScript ? "" : "by " + asked_by(request, spec) + " ";
  const bool is_slow = receipt.way.slow != 0 && receipt.end != SwitchEnd::kRefused;
  std::string text = what(receipt) + when + " " + by + from + "to " + to;
  if (is_slow) text += " slowly, for " + slow_text(receipt, spec) + ",";
  if (receipt.end == SwitchEnd::kDone) return text + done_text(receipt, spec) + bumps(receipt, spec);
  return text + " " + word(receipt.end) + ": " + reason_text(receipt, spec) + rolled_back(receipt, spec) + "\n";
}

std::string receipt_json(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin,
                         const ReceiptFrame& frame) {
  if (receipt.end == SwitchEnd::kNothingToDo) return {};
  const bool is_done = receipt.end == SwitchEnd::kDone;
  const bool has_before = receipt.before != kNoSet, has_wall = frame.wall_ns >= 0;
  const std::uint32_t tries = receipt.end == SwitchEnd::kRefused ? 0 : frame.tries;
  return "{\"number\": " + std::to_string(receipt.number) + ", \"origin_ns\": " +
         (has_wall ? std::to_string(origin.count) : "null") + ", \"from\": " +
         json_name(has_before, has_before ? spec.sets[receipt.before].name : "") + ", \"to\": " +
         json_name(receipt.after != kNoSet, receipt.after != kNoSet ? spec.sets[receipt.after].name : "") + ", " +
         json_way(receipt, spec) + ", \"asked_by\": " + json_asked_by(receipt, spec, frame.asked_by) +
         ", \"end\": \"" +
         word(receipt.end) + "\", \"reason\": " +
         (is_done ? "null" : std::string("\"") + reason_word(receipt.why) + "\"") + ", \"why\": " +
         (is_done ? "null" : json_string(reason_text(receipt, spec))) + ", \"tries\": " + std::to_string(tries) +
         ", \"wall_ns\": " + (has_wall ? std::to_string(frame.wall_ns) : "null") +
         ", \"asked_ns\": " + json_instant(receipt.asked, origin) +
         ", \"armed_ns\": " + json_instant(receipt.armed, origin) + ", \"at_ns\": " + json_instant(receipt.at, origin) +
         ", \"ended_ns\": " + json_instant(receipt.ended, origin) + ", \"took_ns\": " + json_durations(receipt) +
         ", \"tasks\": " + json_list(receipt.tasks, spec) + ", \"variables\": " + json_list(receipt.variables, spec) +
         "}";
}

}  // namespace chimera::control
