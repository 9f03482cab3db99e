// SPDX-License-Identifier: Apache-2.0
// The legality rules, in the order in which verify() calls them. Each adds its faults to the report of the model and
// sets data for later rules. docs/formats/description.md, "What makes a description legal".
#pragma once

#include "chimera/schedule/utilisation.h"
#include "chimera/verify/model.h"

namespace chimera {

// rule_components.cc
/// The component of every task is in the library; no streams; ports within the limits of a group.
void find_components(Model& model);
/// Names under alias, constants, resources, initial and max_step are ports of the right kind; repeated ports have
/// instances. Makes TaskModel::ports.
void link_ports(Model& model);
/// Every resource port has its text.
void require_resources(Model& model);

// rule_sets.cc
/// Configurations name known tasks, each once; `start` and {switch: ...} name known configurations.
void make_sets(Model& model);

// rule_standby.cc
/// Makes Model::standbys of the standbys that name a known task.
void pair_standbys(Model& model);

// rule_components.cc, once the configurations are known
/// A port that may be left out, without alias, joins the variable of its name, if each configuration with the task has
/// a producer of that name, type and unit.
void link_left_out(Model& model);

// rule_links.cc
/// Makes Model::variables; no name stands for a state variable and a constant.
void collect_variables(Model& model);
/// The producers of the variable or constant in that configuration, without the standbys of other producers.
std::vector<PortRef> producers_of(const Model& model, const VariableModel& variable, const SetModel& set);
/// 1994 paper, equation 1: in each configuration no variable has two producers.
void refuse_two_producers(Model& model);
/// 1994 paper, equation 2: in each configuration every input has a producer. Makes Model::unmet; an input that no task
/// produces for joins no other of its name.
void find_unmet_inputs(Model& model);
/// Reports them; called when units are known, because a suggestion has the unit of the input.
void refuse_unmet_inputs(Model& model);

// rule_constants.cc
/// Every in-const has one source. If a constant has several producers, each configuration with a user has just one.
void settle_constants(Model& model);
/// Producers of constants form no circle. Makes Model::init_order.
void order_constants(Model& model);

// rule_types.cc
/// All ports of a variable have one element type; type variables are solved per task.
void agree_on_types(Model& model);
// rule_units.cc
/// All ports of a variable have one unit; unit variables are solved per task.
void agree_on_units(Model& model);
// rule_shapes.cc
/// All ports of a variable can have one shape; extent variables are solved per task.
void agree_on_shapes(Model& model);

// rule_room.cc
/// Every port of a variable reserves the same memory: the least of their maxima, which no legal extent exceeds.
void share_maxima(Model& model);
/// The largest table that a description may ask for.
void limit_table(Model& model);

// rule_values.cc
/// Every value of the description fits its port in type, unit, shape and range. Makes LinkedPort::value.
void check_values(Model& model);

// rule_conditions.cc
/// `safe_when` compares one number or truth value that another configuration or the operator produces.
void check_conditions(Model& model);
/// A condition of the text, and where its variable must have a value.
struct ConditionPlace {
  std::string what;               ///< "'until' of step 1 'approach'"
  const SetModel* set = nullptr;  ///< nullptr: its name is not known
  bool is_until = false;          ///< a task of `set` produces the variable; else of another configuration
};
/// The condition with its limit in the unit of the variable, and the port that settled that; nothing after a fault.
struct JudgedCondition {
  SafeCondition condition;
  std::size_t variable = 0;  ///< in Model::variables
  const LinkedPort* port = nullptr;
};
std::optional<JudgedCondition> judge_condition(Model& model, const DraftCondition& draft, const ConditionPlace& place);

// rule_sequence.cc
/// Each step of `sequence` names a configuration, and has a condition that can hold in it.
void check_sequence(Model& model);

// rule_order.cc
/// No element of a constant is below the constant that its component names as the lower one.
void check_order_of_constants(Model& model);

// rule_loops.cc
/// Every loop of a configuration has an initial value. Makes SetModel::order.
void order_sets(Model& model);

// rule_cycles.cc
/// Makes TaskModel::place: producers before readers, in one order for all configurations. Links within the start
/// configuration count first, then those within the others, then the rest. A standby counts with its primary.
void order_cycles(Model& model);

// rule_timing.cc
/// "1.5 ms": a duration in the largest unit that gives a number of at least 1.
std::string say(Nanoseconds t);
/// Rates, deadlines, offsets, budgets and minimum times fit each other; servers stand on aperiodic components.
void check_times(Model& model);
/// The budgets of a configuration use at most kMaxUtilisation of each CPU. This also holds with a standby in place of
/// its primary, and with hot standbys beside their primaries.
void limit_utilisation(Model& model);

// rule_rtpus.cc
/// Tasks name declared rtpus.
void place_tasks(Model& model);
/// On a CPU with several rtpus no task has a higher band than a more critical task.
void check_bands(Model& model);

// rule_standby.cc
/// A standby names another task, has exactly its outputs, and is not ON beside it.
void check_standbys(Model& model);

// rule_unused.cc
/// Warns of declared parts without a use.
void warn_of_unused(Model& model);

}  // namespace chimera
