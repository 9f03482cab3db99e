// SPDX-License-Identifier: Apache-2.0
// What one context tells of a switch that it took part in: its part of the receipt, as plain data in memory that
// outlives the context. Whoever planned the switch puts the parts together. docs/formats/processes.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "chimera/runtime/switch_page.h"
#include "chimera/runtime/switch_receipt.h"

namespace chimera {

/// Written by its owner before SwitchProgress::over says its number; read when that number was seen, or when the owner
/// is known to be dead. May be anything then: a reader checks every number in it.
struct SwitchPart {
  static constexpr std::uint32_t kVariablesKept = 64, kSaid = 160;

  std::uint32_t number = 0;         ///< of the plan; 0: it took part in none
  SwitchEnd end = SwitchEnd::kDone;
  NoSwitch why = NoSwitch::kNone;   ///< of kAborted, where this context aborted the plan; kNone: another one did
  TaskId task;                      ///< of `why`
  VariableId variable;              ///< of `why`
  double value = 0;                 ///< of `variable`, as SwitchReceipt
  char said[kSaid + 1] = {};        ///< by `on` of `task`
  Nanoseconds armed = kNever;       ///< instants as of SwitchReceipt
  Nanoseconds at = kNever;
  Nanoseconds ended = kNever;
  Nanoseconds flag;                 ///< as SwitchReceipt
  TaskId not_back;
  std::uint32_t n_reinitialised = 0;
  std::uint32_t n_tasks = 0;        ///< of this context, in `tasks`
  std::uint32_t n_variables = 0;    ///< handed over to tasks of this context; only kVariablesKept of them are kept
  std::array<TaskPart, kMaxSwitchedTasks> tasks;
  std::array<TaskId, kMaxSwitchedTasks> reinitialised;
  std::array<VariablePart, kVariablesKept> variables;
};

/// The part of the context whose tasks `is_mine` says are its own. Context: cycle boundary; wait-free.
template <class IsMine>
void write_part(const SwitchReceipt& receipt, IsMine is_mine, SwitchPart& part) noexcept {
  part.end = receipt.end;
  part.why = receipt.why;
  part.task = receipt.task;
  part.variable = receipt.variable;
  part.value = receipt.value;
  std::memcpy(part.said, receipt.said.c_str(), receipt.said.view().size() + 1);
  part.armed = receipt.armed;
  part.at = receipt.at;
  part.ended = receipt.ended;
  part.flag = receipt.flag;
  part.not_back = receipt.not_back;
  part.n_tasks = part.n_variables = part.n_reinitialised = 0;
  for (const TaskId task : receipt.reinitialised) part.reinitialised[part.n_reinitialised++] = task;
  for (const TaskPart& task : receipt.tasks)
    if (is_mine(task.task)) part.tasks[part.n_tasks++] = task;
  for (const VariablePart& variable : receipt.variables) {
    if (!is_mine(variable.handover.to.task)) continue;
    if (part.n_variables < SwitchPart::kVariablesKept) part.variables[part.n_variables] = variable;
    ++part.n_variables;
  }
  part.number = receipt.number;
}

/// The part as a receipt whose lists point into it. The lists are not to be written, and any value may be wrong.
/// Context: setup.
inline void read_part(const SwitchPart& part, SwitchReceipt& receipt) noexcept {
  SwitchPart& lists = const_cast<SwitchPart&>(part);
  receipt = {};
  receipt.number = part.number;
  receipt.end = part.end;
  receipt.why = part.why;
  receipt.task = part.task;
  receipt.variable = part.variable;
  receipt.value = part.value;
  const char* const end = std::find(part.said, part.said + SwitchPart::kSaid, '\0');
  receipt.said.assign({part.said, static_cast<std::size_t>(end - part.said)});
  receipt.armed = part.armed;
  receipt.at = part.at;
  receipt.ended = part.ended;
  receipt.flag = part.flag;
  receipt.not_back = part.not_back;
  receipt.tasks = std::span(lists.tasks).first(std::min<std::size_t>(part.n_tasks, part.tasks.size()));
  receipt.variables = std::span(lists.variables).first(std::min(part.n_variables, SwitchPart::kVariablesKept));
  receipt.reinitialised =
      std::span(lists.reinitialised).first(std::min<std::size_t>(part.n_reinitialised, part.reinitialised.size()));
}

}  // namespace chimera
