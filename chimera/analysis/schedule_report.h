// SPDX-License-Identifier: Apache-2.0
// The result of the analysis (schedule/analysis.h) of a configuration, with the names of the description. For each set
// of tasks and each CPU: the tasks that keep their deadlines, the tasks that would have to give way first, the changes
// that would make the set fit, and the age of data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chimera/analysis/link_age.h"
#include "chimera/analysis/recorded_profile.h"
#include "chimera/analysis/transfer_cost.h"
#include "chimera/description/report.h"
#include "chimera/schedule/analysis.h"
#include "chimera/schedule/worst_window.h"
#include "chimera/verify/configuration.h"

namespace chimera {

struct ScheduleOptions {
  const RecordedProfile* profile = nullptr;  ///< where it has a task its worst time counts, else the budget
  std::optional<Dispatch> dispatch;          ///< of all rtpus; else each as the description says
  Nanoseconds quantum = microseconds(500);   ///< of laxity policies
  std::vector<std::string> may_miss;         ///< tasks that need no promise
  bool one_rtpu = false;                     ///< all tasks in one executive, that of the first rtpu
};

enum class TimeSource : std::uint8_t { kNone, kBudget, kProfile, kServer };

struct ScheduleRow {
  std::size_t task = 0;  ///< in Configuration::tasks()
  Work work;
  TimeSource source = TimeSource::kNone;
  WorkVerdict verdict;
  bool is_hard = true;  ///< must keep its deadlines: no `on_miss: abort`, `tolerate`, `server`, `may_miss`
  TransferCost transfer;
};

/// One change after which a CPU fits.
struct Remedy {
  enum class Kind : std::uint8_t { kExecutor, kRate, kProcessor, kNewProcessor, kCriticality };
  Kind kind = Kind::kRate;
  std::size_t task = 0;
  double hz = 0;                  ///< kRate: at most this
  std::size_t rtpu = 0;           ///< kProcessor: move it there; kExecutor: that rtpu preemptive (and no task)
  std::uint32_t criticality = 0;  ///< kCriticality
  bool is_for_others = false;     ///< kCriticality: all others are promised then, this one may not be
};

struct CpuSchedule {
  CpuVerdict verdict;
  std::vector<ScheduleRow> rows;      ///< in the order of levels
  std::vector<std::size_t> give_way;  ///< rows, in order: without these tasks the rest fits; empty when it does
  std::vector<Remedy> remedies;       ///< the smallest of each kind that was found
  double scale = 0;                   ///< greatest factor of all times with which it fits; 0: none was found
  WorstWindow window;
  std::vector<WindowRun> runs;  ///< `task` as in Configuration::tasks()

  /// All tasks with a time keep their deadlines within kMaxUtilisation of the CPU.
  bool fits() const noexcept;
};

/// A way from a sensor to an actuator. The first and the last task have resource ports and may be the same.
struct PathAge {
  std::vector<std::size_t> tasks;
  Nanoseconds age;  ///< schedule/data_age.h; kNever: some task on it has no bound
};

struct SetSchedule {
  std::string name;
  bool is_start = false;
  std::vector<CpuSchedule> cpus;
  std::vector<TaskLink> links;
  std::vector<PathAge> paths;  ///< oldest first
  bool has_more_paths = false;

  bool fits() const noexcept;
};

struct ScheduleReport {
  std::vector<Dispatch> dispatch;  ///< of each rtpu
  std::vector<SetSchedule> sets;
  std::vector<std::string> notes;  ///< what stands in the profile or was asked for and could not be used

  bool fits() const noexcept;
  /// "executive", "preemptive", or "mixed".
  const char* dispatch_name() const noexcept;
};

/// Context of all: setup.
ScheduleReport schedule_report(const Configuration& configuration, const ScheduleOptions& options);
/// One JSON object, docs/formats/run.md; without a line end.
std::string schedule_json(const Configuration& configuration, const ScheduleReport& report);

/// The hard tasks of the start set that are not guaranteed to keep their deadlines, one fault each, with what would
/// help. Legal: run may begin.
Report unschedulable(const Configuration& configuration, const ScheduleReport& report);

}  // namespace chimera
