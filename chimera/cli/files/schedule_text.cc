// SPDX-License-Identifier: Apache-2.0
// Writes a schedule report as tables, verdicts and a timeline.
#include "chimera/cli/files/schedule_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "chimera/analysis/schedule_words.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/cpu_text.h"
#include "chimera/description/criticality.h"
#include "chimera/draw/timeline.h"
#include "chimera/schedule/utilisation.h"
#include "chimera/text/time_text.h"

namespace chimera::cli {
namespace {

constexpr double kWindowLetters = 60;  // approximate letters of a picture
constexpr std::size_t kMostUnseen = 6;  // names in a line

/// 1, 2 or 5 times a power of ten, so that `length` takes about kWindowLetters of it.
Nanoseconds unit_for(Nanoseconds length) {
  const double wanted = std::max(static_cast<double>(length.count) / kWindowLetters, 1.0);
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double digit = wanted / power;
  return {std::llround(power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10))};
}

class ScheduleLines {
 public:
  explicit ScheduleLines(const Configuration& configuration) : configuration_(configuration) {}

  const std::string& name(std::size_t task) const { return configuration_.tasks()[task].name; }
  std::string rtpu(std::size_t index) const { return std::string(configuration_.rtpus()[index].name); }

  /// Names the rtpus that preempt a running job.
  std::string dispatch(const ScheduleReport& report) const {
    const std::string kind = report.dispatch_name();
    if (kind == "preemptive") return ", preemptive";
    if (kind == "executive") return ", executives: a running job is not preempted";
    std::string names;
    for (std::size_t r = 0; r < report.dispatch.size(); ++r)
      if (report.dispatch[r] == Dispatch::kPreemptive) append_joined(names, ", ", rtpu(r));
    return ", preemptive in " + names + "; in the other rtpus a running job is not preempted";
  }

  std::string cpu(const CpuSchedule& cpu) const {
    std::string text = cpu_text(cpu.verdict.cpu) + ": " + policies(cpu) + "; load " +
                       formatted("%.3f of at most ", cpu.verdict.utilisation) + formatted("%.2f", kMaxUtilisation) +
                       "; rate monotonic bound " + formatted("%.3f", cpu.verdict.rate_monotonic_bound) +
                       ", product of (1 + load) " + formatted("%.3f", cpu.verdict.hyperbolic) + ", enough up to 2\n";
    return text + table(cpu) + verdict(cpu) + unstated(cpu) + remedies(cpu) + window(cpu);
  }

  std::string verdict(const CpuSchedule& cpu) const {
    if (cpu.verdict.unstated == cpu.verdict.tasks)
      return "  nothing to judge: no task has a budget or a recorded time\n";
    const char* who = cpu.verdict.unstated > 0 ? "every task with a time" : "every task";
    if (cpu.fits())
      return std::string("  fits: ") + who + " keeps its deadline" +
             (cpu.scale >= 1.01  ? ", also with all times " + scale_text(cpu.scale)
              : cpu.scale > 0 ? ", with no time to spare"
                              : "") +
             "\n";
    std::string kept, lost;
    for (const ScheduleRow& row : cpu.rows) {
      if (row.verdict.guarantee == Guarantee::kNotStated) continue;
      append_joined(row.verdict.guarantee == Guarantee::kYes ? kept : lost, ", ", name(row.task));
    }
    const std::string giving = join(cpu.give_way, ", ", [&](std::size_t i) { return name(cpu.rows[i].task); });
    std::string text = "  does not fit" + std::string(lost.empty() ? ": the load is too high" : "") + "\n";
    if (!kept.empty()) text += "  guaranteed: " + kept + "\n";
    if (!lost.empty()) text += "  not guaranteed: " + lost + "\n";
    const Demand& demand = cpu.verdict.demand;
    if (demand.within.count > 0)
      text += "  processor demand: jobs due within " + time_text(demand.within) + " are not done in time" +
              (demand.ends == kNever ? "" : ", but after " + time_text(demand.ends)) + "\n";
    if (!giving.empty()) text += "  first to give way: " + giving + "\n";
    return text;
  }

  std::string remedies(const CpuSchedule& cpu) const {
    std::string text;
    const auto add = [&text](const std::string& change) {
      text += (text.empty() ? "  would fit: " : "         or: ") + change + "\n";
    };
    for (const Remedy& r : cpu.remedies) add(remedy_text(configuration_, r));
    if (!cpu.fits() && cpu.scale > 0) add("all times " + scale_text(cpu.scale));
    return text;
  }

  std::string links(const SetSchedule& set) const {
    if (set.links.empty()) return "";
    std::string in_time, late;
    for (const TaskLink& link : set.links) {
      const std::string pair = name(link.from.index) + " -> " + name(link.to.index);
      if (link.periods() == 0) append_joined(in_time, ", ", pair);
      else late += "  1: " + pair + ": " + link.late + "\n";
    }
    if (!in_time.empty()) in_time = "  0: " + in_time + "\n";
    return "links, by how many periods what is read is late:\n" + in_time + late;
  }

  std::string path(const PathAge& path) const {
    return join(path.tasks, " -> ", [this](std::size_t task) { return name(task); }) + ": " +
           (path.age == kNever ? "no bound, a task on it is not guaranteed" : time_text(path.age));
  }

 private:
  std::string policies(const CpuSchedule& cpu) const {
    std::vector<std::string> said;
    for (const ScheduleRow& row : cpu.rows) {
      const RtpuSpec& spec = configuration_.rtpus()[row.work.rtpu];
      const std::string one = "rtpu " + std::string(spec.name) + ", " + std::string(policy_name(spec.policy));
      if (std::find(said.begin(), said.end(), one) == said.end()) said.push_back(one);
    }
    return join(said, ", ");
  }

  std::vector<std::string> cells(const ScheduleRow& row) const {
    constexpr const char* kSources[] = {"not stated", " budget", " profile", " server"};
    const WorkVerdict& v = row.verdict;
    const std::string source = kSources[static_cast<std::size_t>(row.source)];
    const RtpuSpec& spec = configuration_.rtpus()[row.work.rtpu];
    const bool is_beyond = spec.policy == Policy::kRm && spec.preemptive && v.guarantee == Guarantee::kNo;
    std::string response = v.response != kNever ? (v.is_exact ? "" : "at most ") + time_text(v.response)
                           : is_beyond          ? "over " + time_text(row.work.period)
                                                : "no bound";
    const bool is_server = row.work.server.has_value();
    std::string promise = is_server && v.guarantee == Guarantee::kYes ? "capacity given"
                          : v.guarantee == Guarantee::kYes              ? "kept"
                          : v.guarantee == Guarantee::kNo               ? "NOT KEPT"
                          : v.guarantee == Guarantee::kTooLong          ? "NOT DECIDED"
                                                                        : "not judged";
    if (v.guarantee == Guarantee::kNotStated) response = "-";
    if (!row.is_hard && !is_server) promise += ", may miss";
    const std::string transfer = row.transfer.groups == 0 ? "-"
                                 : std::to_string(row.transfer.bytes) + " B, " +
                                       std::to_string(row.transfer.groups) +
                                       (row.transfer.groups == 1 ? " group" : " groups");
    return {name(row.task), rtpu(row.work.rtpu), criticality_name(row.work.criticality),
            (row.source == TimeSource::kNone ? "" : time_text(row.work.time)) + source, time_text(row.work.period),
            time_text(row.work.deadline), response, v.blocking.count == 0 ? "-" : time_text(v.blocking), transfer,
            promise};
  }

  std::string table(const CpuSchedule& cpu) const {
    std::vector<std::vector<std::string>> rows = {{"task", "rtpu", "crit.", "time", "period", "deadline", "response",
                                                   "blocked", "copies", "deadline is"}};
    for (const ScheduleRow& row : cpu.rows) rows.push_back(cells(row));
    std::vector<std::size_t> widths(rows[0].size());
    for (const auto& row : rows)
      for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    std::string text;
    for (const auto& row : rows) {
      std::string line = "  ";
      for (std::size_t c = 0; c < row.size(); ++c) line += row[c] + std::string(widths[c] + 2 - row[c].size(), ' ');
      line.erase(line.find_last_not_of(' ') + 1);
      text += line + "\n";
    }
    return text;
  }

  std::string unstated(const CpuSchedule& cpu) const {
    std::string names;
    for (const ScheduleRow& row : cpu.rows)
      if (row.source == TimeSource::kNone) append_joined(names, ", ", name(row.task));
    if (names.empty()) return "";
    return "  no budget given for " + names +
           ": ignored in this proof; write 'budget:', or record one: "
           "chimera profile --save FILE, then --profile FILE\n";
  }

  std::string window(const CpuSchedule& cpu) const {
    if (cpu.runs.empty()) return "";
    const auto names = names_of(cpu.rows, [this](const ScheduleRow& row) { return name(row.task); });
    std::vector<TapRecord> records;
    for (const WindowRun& run : cpu.runs) {
      const auto row = std::find_if(cpu.rows.begin(), cpu.rows.end(),
                                    [&run](const ScheduleRow& r) { return r.task == run.task; });
      TapRecord record;
      record.at = run.from;
      record.b = (run.to - run.from).count;
      record.task = TaskId(static_cast<std::size_t>(row - cpu.rows.begin()));
      record.kind = TapKind::kRun;
      records.push_back(record);
    }
    const Nanoseconds unit = unit_for(cpu.window.length);
    return "  worst window, a letter for " + time_text(unit) + ":\n" +
           window_text(draw::timeline(records, names, {}, unit, cpu.window.length));
  }

  /// A task without a letter in the picture has none in the legend: in no time unit does it hold the CPU for longest.
  static std::string window_text(draw::Timeline drawn) {
    std::vector<std::string> unseen;
    std::erase_if(drawn.legend, [&](const auto& entry) {
      const bool is_unseen = drawn.letters.find(entry.first) == std::string::npos;
      if (is_unseen) unseen.push_back(entry.second);
      return is_unseen;
    });
    std::string text = draw::text(drawn);
    if (unseen.empty()) return text;
    const std::size_t more = unseen.size() > kMostUnseen ? unseen.size() - kMostUnseen : 0;
    unseen.resize(unseen.size() - more);
    return text + "          too short to be seen here: " + join(unseen, ", ") +
           (more > 0 ? " and " + std::to_string(more) + " more" : "") + "\n";
  }

  const Configuration& configuration_;
};

/// Whether the window opens behind a job that cannot be taken off the processor.
bool has_blocker(const ScheduleReport& report, const CpuSchedule& cpu) {
  for (const ScheduleRow& a : cpu.rows)
    for (const ScheduleRow& b : cpu.rows)
      if (a.task != b.task && a.work.rtpu == b.work.rtpu && a.work.time.count > 0 && b.work.time.count > 0 &&
          report.dispatch[a.work.rtpu] == Dispatch::kExecutive)
        return true;
  return false;
}

std::string paths_text(const ScheduleLines& lines, const SetSchedule& set) {
  if (set.paths.empty()) return "";
  std::string text = "data age, from the release of the sensor's job until what it caused is replaced:\n";
  for (const PathAge& path : set.paths) text += "  " + lines.path(path) + "\n";
  return text + (set.has_more_paths ? "  and more paths than were searched\n" : "");
}

}  // namespace

std::string schedule_text(const Configuration& configuration, const ScheduleReport& report) {
  const ScheduleLines lines(configuration);
  std::string text;
  for (const SetSchedule& set : report.sets) {
    text += configuration.subsystem() + ": configuration '" + set.name + "'" + (set.is_start ? " (start)" : "") +
            lines.dispatch(report) + "\n";
    for (const CpuSchedule& cpu : set.cpus) text += lines.cpu(cpu);
    text += lines.links(set) + paths_text(lines, set);
  }
  return text;
}

std::vector<draw::Gantt> schedule_pictures(const Configuration& configuration, const ScheduleReport& report) {
  const ScheduleLines lines(configuration);
  std::vector<draw::Gantt> pictures;
  for (const SetSchedule& set : report.sets) {
    if (!set.is_start) continue;
    for (const CpuSchedule& cpu : set.cpus) {
      draw::Gantt picture;
      picture.title = configuration.subsystem() + ", " + cpu_text(cpu.verdict.cpu) + ": worst window";
      picture.note =
          "load " + formatted("%.3f", cpu.verdict.utilisation) + "; all released at once" +
          (has_blocker(report, cpu) ? ", the longest job of an executive just begun; " : ", ") +
          "each as long as stated";
      picture.length = cpu.window.length;
      for (const ScheduleRow& row : cpu.rows) {
        draw::GanttRow drawn;
        drawn.name = lines.name(row.task);
        drawn.note = time_text(row.work.time) + " every " + time_text(row.work.period);
        drawn.period = row.work.period;
        drawn.deadline = row.work.deadline;
        drawn.is_late = row.verdict.guarantee == Guarantee::kNo || row.verdict.guarantee == Guarantee::kTooLong;
        for (const WindowRun& run : cpu.runs)
          if (run.task == row.task) drawn.runs.emplace_back(run.from, run.to);
        picture.rows.push_back(std::move(drawn));
      }
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

}  // namespace chimera::cli
