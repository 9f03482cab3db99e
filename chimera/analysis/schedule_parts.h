// SPDX-License-Identifier: Apache-2.0
// The halves of schedule_report() that are files of their own.
#pragma once

#include "chimera/analysis/schedule_report.h"

namespace chimera {

/// Criticalities of the tasks of an rtpu that are not in the set: its band counts them, too.
struct Outside {
  std::uint32_t least = UINT32_MAX, most = 0;
};

/// One set of tasks as the analysis takes it. `tasks[i]` is the task of `works[i]`.
struct SetWorks {
  std::vector<std::size_t> tasks;
  std::vector<Work> works;
  std::vector<ProcessorUse> uses;
  std::vector<Outside> outside;  ///< of each of `uses`
  bool may_preempt = true;       ///< an rtpu may become preemptive: they are not all one loop
};

/// Context of all: setup.
/// Analyses one CPU of the set. `verdicts`, as long as the set, receives what it says of the tasks there.
CpuVerdict analyse(const SetWorks& set, std::uint32_t cpu, std::vector<WorkVerdict>& verdicts);
/// Whether all that has a time on that CPU keeps its deadlines within kMaxUtilisation.
bool fits(const SetWorks& set, std::uint32_t cpu);
/// Tasks that would have to give way first, as indices into the set: without them the rest of the CPU fits.
std::vector<std::size_t> give_way(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts);
/// The smallest change of each kind with which the CPU fits; `Remedy::task` as an index into the set.
std::vector<Remedy> remedies(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts);
/// The greatest factor of all times of that CPU with which it still fits (three digits); 0: no factor was found.
double most_scale(const SetWorks& set, const CpuVerdict& verdict, const std::vector<WorkVerdict>& verdicts);
/// Every way from a task with a resource port to one, over the variables that they link, with its worst data age.
void find_paths(const Configuration& configuration, const SetWorks& set, const std::vector<WorkVerdict>& verdicts,
                SetSchedule& schedule);

}  // namespace chimera
