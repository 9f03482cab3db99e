// SPDX-License-Identifier: Apache-2.0
// Turns a schedule that does not hold into faults of the description, with what would help.
#include <algorithm>

#include "chimera/analysis/schedule_report.h"
#include "chimera/analysis/schedule_words.h"
#include "chimera/description/cpu_text.h"
#include "chimera/text/time_text.h"

namespace chimera {
namespace {

bool is_broken(const ScheduleRow& row) {
  return row.is_hard && (row.verdict.guarantee == Guarantee::kNo || row.verdict.guarantee == Guarantee::kTooLong);
}

/// The first change that makes all tasks of the CPU fit; "": none is known.
std::string what_helps(const Configuration& configuration, const CpuSchedule& cpu) {
  for (const Remedy& remedy : cpu.remedies)
    if (!remedy.is_for_others) return remedy_text(configuration, remedy);
  return cpu.scale > 0 ? "all times at most " + scale_text(cpu.scale) : "";
}

Fault fault_of(const Configuration& configuration, const CpuSchedule& cpu, const ScheduleRow& row) {
  const ConfiguredTask& task = configuration.tasks()[row.task];
  const Nanoseconds response = row.verdict.response;
  const std::string found = response == kNever ? "" : time_text(response);
  const std::string change = what_helps(configuration, cpu);
  const std::string helps = change.empty() ? "" : "all would be with " + change + "; ";
  return {.rule = "unschedulable",
          .at = task.at,
          .message = "task '" + task.name + "' is not guaranteed to keep its deadline of " +
                     time_text(row.work.deadline) + " on " + cpu_text(cpu.verdict.cpu) +
                     (found.empty() ? "" : ": a cycle may take " + found),
          .found = found,
          .expected = "at most " + time_text(row.work.deadline),
          .remedy = helps + "chimera schedule says more, --may-miss " + task.name + " runs it all the same"};
}

}  // namespace

Report unschedulable(const Configuration& configuration, const ScheduleReport& report) {
  Report faults(configuration.file(), configuration.draft().keys);
  for (const SetSchedule& set : report.sets)
    for (const CpuSchedule& cpu : set.cpus)
      for (const ScheduleRow& row : cpu.rows)
        if (set.is_start && is_broken(row)) faults.add(fault_of(configuration, cpu, row));
  faults.sort();
  return faults;
}

}  // namespace chimera
