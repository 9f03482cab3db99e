// SPDX-License-Identifier: Apache-2.0
// The rows of each command. A function that makes a row returns false when there is none left.
#include <algorithm>

#include "chimera/runtime/plan/switch_words.h"
#include "firmware/shell/shell.h"
#include "firmware/shell/shell_rows.h"

namespace chimera::firmware {
namespace {

constexpr std::size_t kFullRow = 100;      // a row of more bytes takes no further element
constexpr std::size_t kStackWords = 128;   // looked at in a step

/// How the present value of a variable is read.
struct Present {
  VariableView view;
  std::uint32_t type = CHIMERA_FLOAT64, bytes = 0;
  std::string_view unit = "1";
};

Present present(const ApplicationSpec& spec, const Sources& sources, std::uint32_t index) noexcept {
  Present value;
  const Variable& variable = spec.variables[index];
  if (variable.is_given()) {
    const GivenSpec& given = spec.operators[variable.operator_index];
    value.type = given.type;
    value.bytes = given.element_bytes;
    if (!variable.consumers.empty())
      if (const PortSpec* port = spec.port(CHIMERA_IN_VAR, variable.consumers[0])) value.unit = port->unit;
    value.view = sources.view(VariableId(index));
    return value;
  }
  const Source& source = sources.source(VariableId(index));
  if (!source.task.is_valid() || !source.here.is_bound()) return value;
  value.view = sources.view(VariableId(index));
  if (value.view.spec == nullptr) return {};
  value.type = value.view.spec->type;
  value.bytes = value.view.spec->element_bytes;
  value.unit = value.view.spec->unit;
  return value;
}

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
  line_ << "stack " << of.name << ": " << scan_.used_bytes() << " of " << of.words.size_bytes() << " bytes used"
        << (of.is_guard_whole() ? "" : ", its guard is overwritten");
  operand_ = 0;
  ++at_;
  return true;
}

bool Shell::make_last_status_row(std::size_t row) noexcept {
  ++at_;
  if (row == 0) {
    if (parts_.watchdog != nullptr) {
      line_ << "watchdog: ";
      put_vital(line_, parts_.watchdog->last(), parts_.set.spec().tasks);
    }
    return true;
  }
  if (row > 1 || lost_bytes() == 0) return false;
  line_ << "input: " << lost_bytes() << " bytes lost";
  return true;
}

bool Shell::make_event_row() noexcept {
  RecentEvents& events = parts_.listener.events();
  if (at_++ == 0) {
    if (const std::uint32_t lost = events.take_lost()) {
      line_ << lost << (lost == 1 ? " older event is lost" : " older events are lost");
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
  line_ << each.name << (each.operands.empty() ? "" : " ") << each.operands << "  " << each.help;
  return true;
}

// An element a step. The elements of a long value may be of several cycles.
bool Shell::make_value_row(Nanoseconds now) noexcept {
  const ApplicationSpec& spec = parts_.set.spec();
  const std::string_view name = spec.variables[index_].name;
  const Present value = present(spec, parts_.set.sources(), index_);
  const bool is_list = value.view.count > 1;
  const bool has_ended = at_ > 0 && at_ >= value.view.count;
  if (has_ended) return false;
  if (at_ == 0 && (value.view.value == nullptr || !value.view.is_valid || value.view.count == 0)) {
    why_ << name << " has no value";
    return false;
  }
  if (value.type > CHIMERA_STRING) {
    why_ << name << " is a struct, which is not shown here";
    return false;
  }
  if (at_ == 0) line_ << name << (is_list ? " = [" : " = ");
  else if (line_.size() > 0) line_ << ' ';
  put_element(line_, value.type, value.bytes, value.view.value + at_ * value.bytes);
  if (++at_ < value.view.count) {
    is_sending_ = line_.size() > kFullRow;
    return true;
  }
  if (is_list) line_ << ']';
  put_unit(line_, value.unit);
  line_ << ", age " << now - Nanoseconds{value.view.slot->published_ns};
  is_sending_ = true;
  return true;
}

void Shell::end_switch() noexcept {
  phase_ = Phase::kAnswer;
  const SwitchReceipt* const receipt = parts_.listener.ordered();
  at_ = 0;
  if (receipt == nullptr) {
    why_ << "the receipt is gone: see events";
  } else if (receipt->end == SwitchEnd::kDone || receipt->end == SwitchEnd::kNothingToDo) {
    phase_ = Phase::kRows;
  } else {
    why_ << end_word(receipt->end) << ", " << reason_word(receipt->why);
    if (receipt->task.is_valid()) why_ << ", task " << parts_.set.spec().tasks[receipt->task.index].name;
    if (receipt->variable.is_valid())
      why_ << ", variable " << parts_.set.spec().variables[receipt->variable.index].name;
    if (!receipt->said.empty()) why_ << ": " << receipt->said.view();
  }
}

bool Shell::make_switch_row() noexcept {
  const SwitchReceipt* const receipt = parts_.listener.ordered();
  if (receipt == nullptr || at_ > receipt->variables.size()) return false;
  const std::size_t row = at_++;
  const ApplicationSpec& spec = parts_.set.spec();
  if (row == 0 && receipt->end == SwitchEnd::kNothingToDo) {
    line_ << spec.sets[act_.index].name << " is in force, nothing to do";
  } else if (row == 0) {
    std::uint64_t lost = 0;
    for (const TaskPart& part : receipt->tasks) lost += part.lost;
    line_ << "changed after ";
    line_.put_us(receipt->at - receipt->asked) << ", " << lost << (lost == 1 ? " cycle lost" : " cycles lost");
  } else {
    const VariablePart& part = receipt->variables[row - 1];
    const ValueStep& step = part.step_of_cycle.is_known ? part.step_of_cycle : part.step_of_on;
    if (!step.is_known) return true;  // no row
    line_ << spec.variables[part.handover.variable.index].name << " moves by " << step.size;
    if (const PortSpec* port = spec.port(CHIMERA_OUT_VAR, part.handover.to)) put_unit(line_, port->unit);
  }
  return true;
}

}  // namespace chimera::firmware
