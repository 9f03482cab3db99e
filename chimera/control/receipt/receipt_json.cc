// SPDX-License-Identifier: Apache-2.0
// Writes receipts as JSON.
#include "chimera/control/receipt/receipt_json.h"

#include <cmath>
#include <optional>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/receipt/receipt_parts.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/text/json_text.h"

namespace chimera::control {
namespace {

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

std::string json_ns(std::optional<Nanoseconds> time) { return time ? std::to_string(time->count) : "null"; }

std::string json_instant(Nanoseconds instant, Nanoseconds origin) {
  return instant == kNever ? "null" : std::to_string((instant - origin).count);
}

std::string json_number(bool is_known, double value) {
  return is_known && std::isfinite(value) ? formatted("%.17g", value) : "null";
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

/// Duration of each phase; null: the switch did not go through it.
std::string json_durations(const SwitchReceipt& receipt) {
  const auto between = [](Nanoseconds from, Nanoseconds to) {
    return from == kNever || to == kNever ? "null" : std::to_string((to - from).count);
  };
  return "{\"arming\": " + between(receipt.asked, receipt.armed) + ", \"agreeing\": " +
         between(receipt.armed, receipt.at) + ", \"ending\": " + between(receipt.at, receipt.ended) + "}";
}

template <class Parts>
std::string json_list(const Parts& parts, const ApplicationSpec& spec) {
  return "[" + join(parts, ", ", [&spec](const auto& part) { return json_of(part, spec); }) + "]";
}

std::string json_way(const SwitchReceipt& receipt, const ApplicationSpec& spec) {
  const bool is_slow = receipt.way.slow != 0;
  const std::string reasons = join(slow_words(receipt.way), ", ", json_string);
  const auto name = [&spec](TaskId task) { return json_string(spec.tasks[task.index].name); };
  const std::string list = join(receipt.reinitialised, ", ", name);
  const bool is_back = !receipt.not_back.is_valid();
  const char* const way = receipt.cause == SwitchCause::kStandby ? "takeover" : is_slow ? "slow" : "fast";
  return std::string("\"way\": \"") + way + "\", \"slow_because\": [" + reasons +
         "], \"slow_why\": " + json_name(is_slow, slow_text(receipt, spec)) + ", \"flag_ns\": " +
         std::to_string(receipt.flag.count) + ", \"reinitialised\": [" + list + "], \"not_back\": " +
         json_name(!is_back, is_back ? "" : spec.tasks[receipt.not_back.index].name);
}

}  // namespace

std::string receipt_json(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin,
                         const ReceiptFrame& frame) {
  if (receipt.end == SwitchEnd::kNothingToDo) return {};
  const bool is_done = receipt.end == SwitchEnd::kDone;
  const bool has_wall = frame.wall_ns >= 0;
  const std::uint32_t tries = receipt.end == SwitchEnd::kRefused ? 0 : receipt.tries;
  return "{\"number\": " + std::to_string(receipt.number) + ", \"origin_ns\": " +
         (has_wall ? std::to_string(origin.count) : "null") + ", \"from\": " +
         json_name(receipt.before != kNoSet, from_text(receipt, spec)) + ", \"to\": " +
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
