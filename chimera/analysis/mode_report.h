// SPDX-License-Identifier: Apache-2.0
// The configurations of a description as nodes, the switches between them as edges: who asks for each without a
// person, and whether the deadlines hold over it (runtime/switch_schedule.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/runtime/switch_schedule.h"
#include "chimera/verify/configuration.h"

namespace chimera {

/// What asks for a switch without a person.
enum class ModeCause : std::uint8_t { kMiss, kOverrun, kFault, kConstant };

/// A task of the configuration before, and by which of its reactions or constants.
struct ModeAsker {
  ModeCause cause = ModeCause::kMiss;
  std::size_t task = 0;  ///< in Configuration::tasks()
  std::string constant;  ///< of kConstant: its name

  bool is_reaction() const noexcept { return cause != ModeCause::kConstant; }
};

/// A switch from sets()[from] to sets()[to]. An operator may ask for each.
struct ModeEdge {
  std::size_t from = 0, to = 0;
  std::vector<ModeAsker> askers;    ///< in the order of tasks
  std::vector<CpuTransition> cpus;  ///< on which a task arrives or leaves

  /// It goes the slow way, under the flag: a promise that holds before would not hold if both were there. Constants,
  /// which only `init` makes, are not looked at.
  bool is_slow() const noexcept;
  bool has_reaction() const noexcept;
};

struct ModeReport {
  std::vector<ModeEdge> edges;              ///< from each configuration to each other, in order
  std::vector<std::size_t> by_operator;     ///< configurations that are not the start and that nobody else asks for
  std::vector<std::string> warnings;

  /// No switch that a reaction asks for is slow.
  bool is_accepted() const noexcept;
};

/// Context of all: setup.
ModeReport mode_report(const Configuration& configuration, const Library& library);
/// "on_miss of heater", "constant when_near of monitor".
std::string asker_text(const Configuration& configuration, const ModeAsker& asker);
/// "yes", "no", "not-stated", "not-decided": of those tasks that must keep their deadlines.
const char* schedulable_word(Guarantee guarantee) noexcept;
/// One JSON object, docs/formats/run.md; without a line end.
std::string mode_json(const Configuration& configuration, const ModeReport& report);

}  // namespace chimera
