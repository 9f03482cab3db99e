// SPDX-License-Identifier: Apache-2.0
// The configurations of a description as nodes, also with a standby in the place of its primary, and the switches
// and takeovers between them as edges. An edge has the tasks that ask for the switch, whether all deadlines are met
// during it (runtime/plan/switch_schedule.h), and whether a constant may change (runtime/plan/constant_choice.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/runtime/plan/switch_schedule.h"
#include "chimera/verify/configuration.h"

namespace chimera {

/// Causes of a switch that no user asks for.
enum class ModeCause : std::uint8_t { kMiss, kOverrun, kFault, kConstant };

/// A task of the configuration before that asks for a switch, and the reaction or constant by which it asks.
struct ModeAsker {
  ModeCause cause = ModeCause::kMiss;
  std::size_t task = 0;  ///< in Configuration::tasks()
  std::string constant;  ///< of kConstant: its name
  std::uint32_t instance = 0;  ///< of kConstant: number of its port among those of a repeated one

  bool is_reaction() const noexcept { return cause != ModeCause::kConstant; }
};

/// A constant of tasks that stay, which another task makes after a switch than before. Only `init` makes the values.
struct ModeConstant {
  std::string name;
  std::size_t before = 0, after = 0;  ///< task that makes it, in Configuration::tasks()
  std::vector<std::size_t> users;     ///< tasks that stay
};

/// A resource that changes hands: runtime/plan/rivals.h.
struct ModeResource {
  std::string text;
  std::size_t before = 0, after = 0;  ///< task that has it, in Configuration::tasks()
};

/// Tasks that may be ON together: a configuration, one with a standby in the place of its primary, or another set that
/// lists of a task lead to.
struct ModeNode {
  std::string name;           ///< "run", "run with spare for main", "run --on spare"
  std::size_t set = 0;        ///< in Configuration::sets()
  TaskId primary, standby;    ///< invalid: no takeover leads to it
  std::vector<TaskId> tasks;
};

/// While the tasks cycle; under the flag unless the values of constants are the same; under the flag; no switch: a
/// standby goes ON when its primary fails.
enum class ModeWay : std::uint8_t { kFast, kSlowUnlessSame, kSlow, kTakeover };

/// From nodes[from] to nodes[to]. An operator may ask for each switch.
struct ModeEdge {
  std::size_t from = 0, to = 0;
  bool is_takeover = false;
  std::vector<ModeAsker> askers;        ///< of a switch, in the order of tasks
  std::vector<CpuTransition> cpus;      ///< on which a task arrives or leaves
  std::vector<ModeConstant> constants;  ///< of a switch
  std::vector<ModeResource> resources;  ///< of a switch
  std::vector<std::size_t> anew;        ///< tasks that stay and are initialised anew if the values of constants differ

  /// kSlow: a promise that holds before would not hold if both were there, or a resource changes hands.
  ModeWay way() const noexcept;
  /// A promise that holds before would not hold if both were there.
  bool breaks_promise() const noexcept;
  bool has_reaction() const noexcept;
};

struct ModeReport {
  std::vector<ModeNode> nodes;           ///< the configurations in order, those with a standby, sets of lists
  std::vector<ModeEdge> edges;           ///< from each node to each configuration, and to what its tasks lead
  std::vector<std::size_t> by_operator;  ///< configurations that are not the start and that only an operator asks for
  std::vector<std::string> warnings;

  /// No switch that a reaction asks for is slow because of a deadline.
  bool is_accepted() const noexcept;
};

/// Context of all: setup.
ModeReport mode_report(const Configuration& configuration, const Library& library);
/// "on_miss of heater", "constant when_near of monitor", "step 2 'weld_it' of the sequence".
std::string asker_text(const Configuration& configuration, const ModeAsker& asker);
/// "yes", "no", "not-stated", "not-decided": of those tasks that must keep their deadlines.
const char* schedulable_word(Guarantee guarantee) noexcept;
/// One JSON object, docs/formats/run.md; without a line end.
std::string mode_json(const Configuration& configuration, const ModeReport& report);

}  // namespace chimera
