// SPDX-License-Identifier: Apache-2.0
// The rows of each command. A function that makes a row returns false when there is none left.
#include <algorithm>

#include "firmware/shell/shell.h"
#include "firmware/shell/shell_rows.h"

namespace chimera::firmware {
namespace {

constexpr std::size_t kFullRow = 100;      // a row of more bytes takes no further element
constexpr std::size_t kStackWords = 128;   // looked at in a step

}  // namespace

bool Shell::make_row(Nanoseconds now) noexcept {
  const Verb verb = command_.command->verb;
  if (verb == Verb::kGet) return make_value_row(now);
  const bool is_there = verb == Verb::kStatus   ? make_status_row(now)
                        : verb == Verb::kSwitch ? make_switch_row()
                        : verb == Verb::kEvents ? make_event_row()
                        : verb == Verb::kHelp
                            ? make_help_row()
                            : put_profile(line_, parts_.set.tasks()[index_], at_++, parts_.releases.origin());
  if (is_there && line_.size() > 0) is_sending_ = true;
  return is_there;
}

bool Shell::make_status_row(Nanoseconds now) noexcept {
  const std::span<const Task> tasks = parts_.set.tasks();
  if (at_ == 0) {
    put_head(line_, parts_.set, now - parts_.releases.origin());
  } else if (at_ <= tasks.size()) {
    put_task(line_, tasks[at_ - 1]);
  } else {
    return make_stack_row();
  }
  ++at_;
  return true;
}

bool Shell::make_stack_row() noexcept {
  const std::size_t stack = at_ - 1 - parts_.set.tasks().size();
  if (stack >= parts_.stacks.size()) return make_last_status_row(stack - parts_.stacks.size());
  const Stack& of = parts_.stacks[stack];
  if (operand_++ == 0) scan_ = StackScan(of);
  if (!scan_.go_on(kStackWords)) return true;  // no row yet
  line_.put("stack %s: %u of %u bytes used%z", of.name, scan_.used_bytes(), of.words.size_bytes(),
            of.is_guard_whole() ? "" : ", its guard is overwritten");
  operand_ = 0;
  ++at_;
  return true;
}

bool Shell::make_last_status_row(std::size_t row) noexcept {
  ++at_;
  if (row == 0) {
    if (parts_.watchdog != nullptr) {
      line_.put("watchdog: ");
      put_vital(line_, parts_.watchdog->last(), parts_.set.spec().tasks);
    }
    return true;
  }
  if (row == 1) {
    if (parts_.boot != nullptr) put_boot(line_, *parts_.boot, parts_.set.spec().tasks);
    return true;
  }
  if (row > 2 || lost_bytes() == 0) return false;
  line_.put("input: at least %u bytes lost", lost_bytes());
  return true;
}

bool Shell::make_event_row() noexcept {
  RecentEvents& events = parts_.listener.events();
  if (at_++ == 0) {
    if (const std::uint32_t lost = events.take_lost()) {
      line_.put("older events lost: %u", lost);
      return true;
    }
  }
  const ShellEvent* const event = at_ > RecentEvents::kKept + 1 ? nullptr : events.take();
  if (event == nullptr) return false;
  put_event(line_, *event, parts_.set.spec(), parts_.releases.origin());
  return true;
}

bool Shell::make_help_row() noexcept {
  if (at_ == commands().size()) return false;
  const CommandSpec& each = commands()[at_++];
  line_.put("%z %z", each.name, each.operands);
  return true;
}

// An element a step. The elements of a long value may be of several cycles.
bool Shell::make_value_row(Nanoseconds now) noexcept {
  const Sources& sources = parts_.set.sources();
  const Source& source = sources.source(VariableId(index_));
  VariableView view;
  if (is_given(index_) || (source.task.is_valid() && source.here.is_bound())) view = sources.view(VariableId(index_));
  const ValueShape shape = shape_of(index_, view.spec);
  if (at_ > 0 && at_ >= view.count) return false;
  if (view.value == nullptr || !view.is_valid || view.count == 0 || shape.element_bytes == 0) {
    why_.put("%s has no value", shape.name);
    return false;
  }
  if (shape.type > CHIMERA_STRING) {
    why_.put("%s is a struct", shape.name);
    return false;
  }
  const bool is_list = view.count > 1;
  if (at_ == 0) line_.put("%s = %z", shape.name, is_list ? "[" : "");
  else if (line_.size() > 0) line_ << ' ';
  put_element(line_, shape.type, shape.element_bytes, view.value + at_ * shape.element_bytes);
  is_sending_ = ++at_ == view.count || line_.size() > kFullRow;
  if (at_ < view.count) return true;
  if (is_list) line_ << ']';
  put_unit(line_, shape.unit);
  line_.put(", age %t", now - Nanoseconds{view.slot->published_ns});
  return true;
}

void Shell::end_switch() noexcept {
  phase_ = Phase::kAnswer;
  const SwitchReceipt* const receipt = parts_.listener.ordered();
  at_ = 0;
  if (receipt == nullptr) {
    why_.put("the receipt is gone: see events");
  } else if (receipt->end == SwitchEnd::kDone || receipt->end == SwitchEnd::kNothingToDo) {
    phase_ = Phase::kRows;
  } else {
    const ApplicationSpec& spec = parts_.set.spec();
    put_end(why_, receipt->end, receipt->why, receipt->task, spec);
    if (receipt->variable.is_valid()) why_.put(", variable %s", spec.variables[receipt->variable.index].name);
    if (!receipt->said.empty()) why_.put(": %z", receipt->said.c_str());
  }
}

bool Shell::make_switch_row() noexcept {
  const SwitchReceipt* const receipt = parts_.listener.ordered();
  if (receipt == nullptr || at_ > receipt->variables.size()) return false;
  const std::size_t row = at_++;
  const ApplicationSpec& spec = parts_.set.spec();
  if (row == 0 && receipt->end == SwitchEnd::kNothingToDo) {
    line_.put("%s is in force, nothing to do", spec.sets[act_.index].name);
  } else if (row == 0) {
    std::uint32_t lost = 0;
    for (const TaskPart& part : receipt->tasks) lost += static_cast<std::uint32_t>(part.lost);
    line_.put("changed after %m, cycles lost: %u", receipt->at - receipt->asked, lost);
  } else {
    const VariablePart& part = receipt->variables[row - 1];
    const ValueStep& step = part.step_of_cycle.is_known ? part.step_of_cycle : part.step_of_on;
    if (!step.is_known) return true;  // no row
    line_.put("%s moves by %g", spec.variables[part.handover.variable.index].name, step.size);
    if (const PortSpec* port = spec.port(CHIMERA_OUT_VAR, part.handover.to)) put_unit(line_, port->unit);
  }
  return true;
}

}  // namespace chimera::firmware
