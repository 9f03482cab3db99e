// SPDX-License-Identifier: Apache-2.0
// Puts receipts into lines.
#include "chimera/control/receipt/receipt_text.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/control/receipt/receipt_parts.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/text/time_text.h"

namespace chimera::control {
namespace {

std::string at(Nanoseconds instant, Nanoseconds origin) { return formatted("%.3f s", to_seconds(instant - origin)); }

/// "switch 3", "takeover 4".
std::string what(const SwitchReceipt& receipt) {
  return (receipt.cause == SwitchCause::kStandby ? "takeover " : "switch ") + std::to_string(receipt.number);
}

std::size_t count(const SwitchReceipt& receipt, TaskMove move) {
  std::size_t n = 0;
  for (const TaskPart& part : receipt.tasks) n += part.move == move ? 1 : 0;
  return n;
}

std::string names(std::span<const TaskId> tasks, const ApplicationSpec& spec) {
  return join(tasks, ", ", [&spec](TaskId task) { return spec.tasks[task.index].name; });
}

std::string after_text(const SwitchReceipt& receipt) {
  return formatted(" after %.3f ms", to_seconds(receipt.at - receipt.asked) * 1e3);
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
  const auto name = [&](TaskId task) { return in_quotes(spec.tasks[task.index].name); };
  const std::string text = what(receipt) + " at " + at(receipt.asked, origin) + " by " + name(receipt.by) + " from " +
                           name(receipt.in_place_of) +
                           (receipt.was_death ? ", whose rtpu died," : ", which is in ERROR,");
  if (receipt.end != SwitchEnd::kDone) return text + " aborted: " + reason_text(receipt, spec) + "\n";
  std::uint64_t lost = 0;
  for (const TaskPart& part : receipt.tasks) lost += part.lost;
  const std::string flag =
      receipt.flag > Nanoseconds{} ? ", " + time_text(receipt.flag) + " under the flag" : std::string();
  return text + after_text(receipt) + flag + ": " + counted(lost, "cycle lost", "cycles lost") +
         moves_text(receipt, spec) + "\n" + bumps(receipt, spec);
}

/// Behind a line of the text, of a slow switch.
std::string rolled_back(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  if (receipt.way.slow == 0 || receipt.end != SwitchEnd::kAborted || receipt.flag == Nanoseconds{}) return "";
  std::string text = "; rolled back, " + time_text(receipt.flag) + " under the flag";
  if (receipt.not_back.is_valid())
    text += "; task " + in_quotes(spec.tasks[receipt.not_back.index].name) + " did not come back";
  return text;
}

}  // namespace

std::vector<std::string> bump_lines(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  std::vector<std::string> lines;
  const bool is_takeover = receipt.cause == SwitchCause::kStandby;  // whose `on` is not held against its limit before
  for (const VariablePart& part : receipt.variables) {
    const ValueStep& step = is_takeover ? seen(part) : part.step_of_cycle;
    if (!step.is_beyond) continue;
    const std::string task = in_quotes(spec.tasks[part.handover.to.task.index].name);
    const std::string variable = in_quotes(spec.variables[part.handover.variable.index].name);
    lines.push_back("bump: after " + what(receipt) + " the first " + (part.step_of_cycle.is_known ? "cycle" : "value") +
                    " of task " + task + " moved " + variable + " by " + step_text(step, unit_text(part, spec)));
  }
  return lines;
}

std::string receipt_text(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin) {
  if (receipt.cause == SwitchCause::kStandby) return takeover_text(receipt, spec, origin);
  const std::string to = set_text(receipt.after, spec);
  const std::string when = " at " + at(receipt.asked, origin);
  if (receipt.end == SwitchEnd::kNothingToDo)
    return "switch" + when + ": " + (receipt.after == kNoSet ? "these tasks are" : to + " is") +
           " in force, nothing to do\n";
  const std::string from = receipt.before == kNoSet ? "" : "from " + in_quotes(from_text(receipt, spec)) + " ";
  const SwitchRequest request{receipt.after, receipt.cause, receipt.by};
  const std::string by = receipt.cause == SwitchCause::kScript ? "" : "by " + asked_by(request, spec) + " ";
  const bool is_slow = receipt.way.slow != 0 && receipt.end != SwitchEnd::kRefused;
  std::string text = what(receipt) + when + " " + by + from + "to " + to;
  if (is_slow) text += " slowly, for " + slow_text(receipt, spec) + ",";
  if (receipt.end == SwitchEnd::kDone) return text + done_text(receipt, spec) + bumps(receipt, spec);
  return text + " " + word(receipt.end) + ": " + reason_text(receipt, spec) + rolled_back(receipt, spec) + "\n";
}

}  // namespace chimera::control
