// SPDX-License-Identifier: Apache-2.0
// The set of tasks that "these ON, those OFF" leads to. Tasks that produce the same variables as a new one go OFF. A
// missing producer goes ON too, if there is only one candidate. The result is judged as a configuration is.
#pragma once

#include <string>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/task_lists.h"

namespace chimera {

/// Result of asked_set().
struct AskedSet {
  TaskBits tasks;      ///< of a set that may be switched to
  std::string why;     ///< "": it may be; else what is wrong with it
  std::string remedy;  ///< "" or what would help

  explicit operator bool() const noexcept { return why.empty(); }
  /// Both, in one line.
  std::string text() const { return remedy.empty() ? why : why + "; " + remedy; }
};

/// From the tasks that are ON: all of `lists.plus`, none of `lists.minus`. Refuses what breaks an equation, has a loop
/// of data without an initial value, takes more of a CPU than check allows, or needs a choice (named). Requires: the
/// lists name tasks of the spec. `on_one_cpu`: all rtpus share the CPU of the first. Context: setup.
AskedSet asked_set(const ApplicationSpec& spec, const TaskBits& on, const TaskLists& lists, bool on_one_cpu = false);

/// "--on a b --off c", in the order of the spec. Context: setup.
std::string lists_text(const TaskLists& lists, const ApplicationSpec& spec);

}  // namespace chimera
