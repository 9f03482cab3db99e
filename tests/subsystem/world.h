// SPDX-License-Identifier: Apache-2.0
// State that the parts of the simulation share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/variables.h"
#include "chimera/subsystem/subsystem.h"
#include "tests/subsystem/agenda.h"
#include "tests/subsystem/chance.h"
#include "tests/subsystem/plan.h"
#include "tests/subsystem/tally.h"
#include "tests/subsystem/trace.h"

namespace chimera::simulated {

class Process;
class Keeper;
class ManagerLoop;
class Face;
class Judge;

/// A deliberate mistake between the Subsystem and the world: proves that the simulation would find it.
enum class Defect {
  kNone,
  kJudgesNothing,        ///< every ON set counts as legal
  kForgetsGoals,         ///< RememberGoal is not carried out
  kBelievesOffEarly,     ///< an `off` counts as reported when it is sent
  kIgnoresAbsentDeaths,  ///< deaths while no manager lived count as handled
  kLeavesOn,             ///< a failed transaction turns no task OFF
  kHasNoClock,           ///< never a Tick
};

struct ManagerState {
  ManagerState(std::uint64_t seed, Defect planted, bool prints);
  ~ManagerState();

  Nanoseconds now() const noexcept { return agenda.now(); }
  std::size_t n_tasks() const noexcept { return plan.spec.tasks.size(); }
  Process& process_of(TaskId task) const { return *processes[plan.spec.tasks[task.index].rtpu.index]; }
  /// The first thing that must not be counts.
  void fail(std::string what);
  template <class... Values>
  void note(std::string_view what, Values... values) {
    trace.note(now(), what, {static_cast<std::int64_t>(values)...});
  }

  Chance chance;
  Trace trace;
  Agenda agenda;
  Plan plan;
  Variables variables;
  Tally tally;
  Defect defect;
  bool is_calm = false;  ///< no fault comes by itself any more
  std::uint64_t signals = 0;
  std::uint64_t deaths = 0;
  std::uint32_t changes = 0;  ///< of the decision page
  std::string failure;

  std::vector<std::unique_ptr<Process>> processes;
  std::unique_ptr<Keeper> keeper;
  std::unique_ptr<ManagerLoop> driver;
  std::vector<std::unique_ptr<Face>> faces;
  std::unique_ptr<Judge> judge;
};

}  // namespace chimera::simulated
