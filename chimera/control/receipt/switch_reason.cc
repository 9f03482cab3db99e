// SPDX-License-Identifier: Apache-2.0
// Puts reasons of switches into words.
#include "chimera/control/receipt/switch_reason.h"

#include <cmath>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/receipt/receipt_parts.h"
#include "chimera/description/cpu_text.h"
#include "chimera/text/time_text.h"

namespace chimera::control {
namespace {

/// "'speed' is 3 rad/s, and safe_when of 'hand' asks for speed < 0.1 rad/s".
std::string unsafe_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const SafeCondition& asked = asked_of(spec, receipt.after);
  if (!asked.is_there() || receipt.variable != asked.variable) return reason_word(receipt.why);
  const PortSpec* const port = port_of(spec.variables[asked.variable.index], spec);
  const std::string unit = port == nullptr ? "" : unit_text(std::string(port->unit));
  std::string name(spec.variables[asked.variable.index].name);
  if (port != nullptr && port->max_count() > 1) name += "[" + std::to_string(asked.element) + "]";
  const std::string is = std::isnan(receipt.value) ? " has no value" : " is " + number_text(receipt.value) + unit;
  return "'" + name + "'" + is + ", and safe_when of " + set_text(receipt.after, spec) + " asks for " + name + " " +
         sign_of(asked.comparison) + " " + number_text(asked.limit) + unit;
}

/// Names the transition that is not schedulable, and the task that would miss its deadline.
std::string not_schedulable(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const TaskId late = receipt.way.deadline.task;
  if (!late.is_valid()) return reason_word(NoSwitch::kNotSchedulable);
  const TaskSpec& task = spec.tasks[late.index];
  const std::string from = receipt.before == kNoSet ? "what is ON" : in_quotes(from_text(receipt, spec));
  const Nanoseconds takes = receipt.way.deadline.takes;
  return "the transition from " + from + " to " + set_text(receipt.after, spec) +
         " is not schedulable on " + cpu_text(spec.rtpus[task.rtpu.index].cpu) + ": a cycle of task " +
         in_quotes(task.name) + " may take " +
         (takes == kNever ? "longer than its deadline of " + time_text(task.deadline)
                          : time_text(takes) + ", its deadline is " + time_text(task.deadline));
}

/// ", for 10 s": from the request to the end, rounded to three digits; the time of undoing is in it.
std::string waited_text(const SwitchReceipt& receipt) {
  if (receipt.asked == kNever || receipt.ended == kNever || receipt.ended <= receipt.asked) return "";
  const std::int64_t waited = (receipt.ended - receipt.asked).count;
  std::int64_t unit = 1;
  while (waited / unit >= 1000) unit *= 10;
  return ", for " + time_text(Nanoseconds{(waited + unit / 2) / unit * unit});
}

std::string gapless_text(const SwitchWay& way, const ApplicationSpec& spec) {
  if (!way.gapless.is_valid()) return "on of an arriving task fits no gap";
  return "on of task " + in_quotes(spec.tasks[way.gapless.index].name) + " needs a gap of " + time_text(way.needed) +
         ", and its rtpu has none";
}

std::string absent_text(const SwitchWay& way, const ApplicationSpec& spec) {
  if (!way.absent.is_valid()) return "an arriving task has the resource of another one";
  const std::string text = "task " + in_quotes(spec.tasks[way.absent.index].name) + " is NOT-CREATED";
  if (!way.rival.is_valid()) return text;
  return text + ": task " + in_quotes(spec.tasks[way.rival.index].name) + " has its resource";
}

}  // namespace

std::string set_text(std::uint32_t set, const ApplicationSpec& spec) {
  return set == kNoSet ? "other tasks" : in_quotes(spec.sets[set].name);
}

std::string set_with_standbys(std::uint32_t set, const ApplicationSpec& spec,
                              const std::function<bool(TaskId)>& is_on) {
  std::string name(spec.sets[set].name);
  const char* joint = " with ";
  for (const TaskId task : spec.sets[set].order) {
    if (is_on(task)) continue;
    TaskId by(0u);
    while (by.index < spec.tasks.size() && !(spec.stand_in(task, by) && is_on(by))) ++by.index;
    if (by.index == spec.tasks.size()) continue;
    name += joint + std::string(spec.tasks[by.index].name) + " for " + std::string(spec.tasks[task.index].name);
    joint = " and ";
  }
  return name;
}

std::string from_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  if (receipt.before == kNoSet) return "";
  return set_with_standbys(receipt.before, spec, [&receipt](TaskId task) { return receipt.on_before.has(task); });
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
  const auto add = [&text](const std::string& why) { append_joined(text, "; ", why); };
  if ((way.slow & kSlowForConstants) != 0 && way.constant.task.is_valid())
    add("constant " + in_quotes(spec.constants[way.constant.constant.index].name) + " of task " +
        in_quotes(spec.tasks[way.constant.task.index].name) + ", which stays, changes");
  if ((way.slow & kSlowForGap) != 0) add(gapless_text(way, spec));
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

std::string reason_text(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const std::string task = receipt.task.is_valid() ? in_quotes(spec.tasks[receipt.task.index].name) : "";
  const VariableId moved = receipt.variable;
  const std::string variable = moved.is_valid() ? in_quotes(spec.variables[moved.index].name) : "";
  switch (receipt.why) {
    case NoSwitch::kInError: return "task " + task + " is in ERROR: clear it first";
    case NoSwitch::kNotCreated: return "task " + task + " is not there: spawn it first";
    case NoSwitch::kKeptOff: return "an operator turned task " + task + " OFF";
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
      return task.empty() ? "the processor was never idle" + waited_text(receipt)
                          : "the processor was never idle for as long as on of task " + task + " takes" +
                                waited_text(receipt);
    case NoSwitch::kNoValue: return "task " + task + " had no value of " + variable + waited_text(receipt);
    case NoSwitch::kNotSafe: return unsafe_text(receipt, spec);
    case NoSwitch::kDisturbed: return "task " + task + " went to another state during the switch";
    case NoSwitch::kFlagRaised: return "the illegal-configuration flag was raised during the switch";
    case NoSwitch::kRunEnded: return "the run ended";
    case NoSwitch::kLate: return "an rtpu was too late to agree to the instant of the change";
    case NoSwitch::kMemberDied: return "an rtpu died";
    case NoSwitch::kDamaged: return "the order on the decision page is not what the manager wrote";
    case NoSwitch::kCancelled: {
      const std::string by(receipt.said.view());
      return by.empty() ? "cancelled" : "cancelled by " + by;
    }
    case NoSwitch::kBadConstant:
      return "task " + task + " cannot be initialised with the constants of " +
             in_quotes(spec.sets[receipt.after].name) + ": " + std::string(receipt.said.view());
    case NoSwitch::kStepFailed: return "a method of task " + task + " failed: " + std::string(receipt.said.view());
    case NoSwitch::kNotReady:
      return (task.empty() ? "an rtpu" : "task " + task) + " was not ready" + waited_text(receipt);
    case NoSwitch::kNoAnswer: return "an rtpu did not answer" + waited_text(receipt);
    default: return reason_word(receipt.why);
  }
}

}  // namespace chimera::control
