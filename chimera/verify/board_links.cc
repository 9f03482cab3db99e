// SPDX-License-Identifier: Apache-2.0
// Judges each rtpu with `link` by the application as the runtime gets it.
#include "chimera/verify/board_links.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/link/frame.h"
#include "chimera/runtime/link/link_layout.h"
#include "chimera/text/time_text.h"

namespace chimera {
namespace {

/// A frame with the text of a fault is longer; the frame behind it then comes late.
std::size_t usual_bytes(const board_link::LinkLayout& layout) {
  return std::max(layout.to_board_bytes(), layout.fault_at());
}

constexpr double kMostOfLine = 0.8;  // the rest is for text lines and for clocks that differ

class BoardLinks {
 public:
  BoardLinks(const Configuration& configuration, Report& report)
      : configuration_(configuration), spec_(configuration.spec()), report_(report) {}

  void judge() {
    for (std::size_t r = 0; r < spec_.rtpus.size(); ++r) {
      if (!spec_.rtpus[r].link.is_there()) continue;
      rtpu_ = RtpuId(r);
      name_ = in_quotes(spec_.rtpus[r].name);
      features();
      constants();
      producers();
      line();
    }
  }

 private:
  void refuse(Place at, std::string message, std::string remedy) {
    report_.add({.rule = "board-rtpu", .at = at, .message = std::move(message), .remedy = std::move(remedy)});
  }
  void refuse_task(TaskId task, const char* what, const char* remedy) {
    refuse(place_of(task), "task " + task_name(task) + " " + what + ", and runs on the board " + name_, remedy);
  }
  bool is_here(TaskId task) const { return spec_.tasks[task.index].rtpu == rtpu_; }
  const DraftRtpu& draft() const { return configuration_.draft().rtpus[rtpu_.index]; }
  Place place_of(TaskId task) const { return configuration_.tasks()[task.index].at; }
  std::string task_name(TaskId task) const { return in_quotes(spec_.tasks[task.index].name); }

  void features() {
    if (draft().preemptive.value)
      refuse(draft().preemptive.at, "'executor: preemptive' of rtpu " + name_ + ", which is a board",
             "leave it out: one loop runs all jobs of a board");
    for (std::size_t t = 0; t < spec_.tasks.size(); ++t) {
      if (!is_here(TaskId(t))) continue;
      const TaskSpec& task = spec_.tasks[t];
      if (task.server) refuse_task(TaskId(t), "has 'server'", "leave it out, or move the task to another rtpu");
      if (task.on_miss == OnMiss::kSwitch || task.on_overrun == OnMiss::kSwitch || task.on_fault == OnFault::kSwitch)
        refuse_task(TaskId(t), "has the reaction 'switch'", "use another reaction: a board does not switch by itself");
      if (configuration_.draft().sequence && task.component == "sequence")
        refuse_task(TaskId(t), "goes through the configurations", "write 'rtpu' of another rtpu in 'sequence'");
    }
    for (const Variable& variable : spec_.variables) {
      const PortSpec* port = board_link::import_port(spec_, rtpu_, variable);
      if (port == nullptr || port->type != CHIMERA_STRUCT) continue;
      refuse(draft().link->at,
             "variable " + in_quotes(variable.name) + " is a struct that the board " + name_ + " reads",
             "split it into numbers on Linux: a link carries structs only from a board");
    }
    for (const StandbySpec& each : spec_.standbys)
      if (is_here(each.primary) || is_here(each.standby))
        refuse(place_of(each.standby),
               "task " + task_name(each.standby) + " is a standby for " + task_name(each.primary) +
                   ", and one of them runs on the board " + name_,
               "leave 'standby_for' out: a takeover between Linux and a board is not built");
  }

  void constants() {
    for (const ConstantSpec& constant : spec_.constants)
      for (const PortOf& producer : constant.producers)
        for (std::size_t t = 0; t < spec_.tasks.size(); ++t)
          if (spec_.uses(TaskId(t), ConstantId(static_cast<std::size_t>(&constant - spec_.constants.data()))) &&
              (is_here(producer.task) || is_here(TaskId(t)))) {
            refuse(place_of(producer.task),
                   "task " + task_name(producer.task) + " produces the constant " + in_quotes(constant.name) +
                       " for task " + task_name(TaskId(t)) + ", and one of them runs on the board " + name_,
                   "write the value under 'constants': constants of tasks do not reach a board");
            return;
          }
  }

  void producers() {
    for (const Variable& variable : spec_.variables) {
      const PortOf* here = variable.producer([&](TaskId task) { return is_here(task); });
      const PortOf* there = variable.producer([&](TaskId task) { return !is_here(task); });
      if (here == nullptr || there == nullptr) continue;
      refuse(place_of(here->task),
             "variable " + in_quotes(variable.name) + " is produced by task " + task_name(here->task) +
                 " on the board " + name_ + " and by task " + task_name(there->task) + " elsewhere",
             "let one side produce it, or give the variables two names and select one on Linux");
    }
  }

  void line() {
    const LinkSpec& link = spec_.rtpus[rtpu_.index].link;
    const board_link::LinkSize size = board_link::LinkSize::of(spec_, rtpu_);
    const Place at = draft().link->at;
    if (size.tasks > board_link::kMostTasks || size.imports > board_link::kMostImports)
      return refuse(at, "rtpu " + name_ + " has " + counted(size.tasks, "task") + " that read " +
                            counted(size.imports, "variable") + " of other rtpus; a link carries " +
                            std::to_string(board_link::kMostTasks) + " and " + std::to_string(board_link::kMostImports),
                    "move tasks to another rtpu");
    HeapMemory memory;
    board_link::LinkLayout layout;
    layout.plan(spec_, rtpu_, memory);
    const std::size_t most = std::max(layout.to_board_bytes(), layout.most_from_board_bytes());
    if (most > board_link::kMostPayload)
      return refuse(at, "a frame of the link of rtpu " + name_ + " would have " + std::to_string(most) +
                            " bytes; at most " + std::to_string(board_link::kMostPayload) + " are possible",
                    "make its variables smaller, or move tasks to another rtpu");
    const Nanoseconds used = line_time(link, usual_bytes(layout));
    if (static_cast<double>(used.count) <= kMostOfLine * static_cast<double>(link.period.count)) return;
    const double hz = kMostOfLine * 1e9 / static_cast<double>(used.count);
    report_.add({.rule = "link-time",
                 .at = draft().link->rate.at,
                 .message = "a frame of the link of rtpu " + name_ + " takes " + time_text(used) + " at " +
                            std::to_string(link.baud) + " baud, and one is sent every " + time_text(link.period),
                 .expected = "at most 80 % of a period",
                 .remedy = "write a rate of at most " + formatted("%.3g", hz) +
                           " Hz, or a higher 'baud', also in the target"});
  }

  const Configuration& configuration_;
  const ApplicationSpec& spec_;
  Report& report_;
  RtpuId rtpu_;
  std::string name_;
};

}  // namespace

Nanoseconds link_delay(const ApplicationSpec& spec, TaskId from, TaskId to) {
  Nanoseconds delay;
  if (spec.tasks[from.index].rtpu == spec.tasks[to.index].rtpu) return delay;
  for (const TaskId end : {from, to}) {
    const TaskSpec& task = spec.tasks[end.index];
    const LinkSpec& link = spec.rtpus[task.rtpu.index].link;
    if (!link.is_there()) continue;
    HeapMemory memory;
    board_link::LinkLayout layout;
    layout.plan(spec, task.rtpu, memory);
    delay += link.period + line_time(link, usual_bytes(layout)) + task.period;
  }
  return delay;
}

Nanoseconds line_time(const LinkSpec& link, std::size_t payload_bytes) {
  if (link.is_udp) return {};
  return Nanoseconds{static_cast<std::int64_t>(board_link::line_bytes(payload_bytes)) * 10 * 1'000'000'000 / link.baud};
}

void judge_board_links(const Configuration& configuration, Report& report) {
  BoardLinks(configuration, report).judge();
}

}  // namespace chimera
