// SPDX-License-Identifier: Apache-2.0
// Writes what is known of each switch between configurations, a paragraph for each.
#include "chimera/cli/files/modes_text.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/description/cpu_text.h"
#include "chimera/text/time_text.h"

namespace chimera::cli {
namespace {

class ModeLines {
 public:
  ModeLines(const Configuration& configuration, const ModeReport& report)
      : configuration_(configuration), report_(report) {}

  std::string edge(const ModeEdge& edge) const {
    std::string text = node(edge.from) + " -> " + node(edge.to) + ": " + head(edge) + "\n";
    for (const CpuTransition& one : edge.cpus) text += "  " + cpu_text(one.cpu) + ": " + cpu(one) + "\n";
    for (const ModeConstant& one : edge.constants) text += "  constant '" + one.name + "' " + constant(one) + "\n";
    for (const ModeResource& one : edge.resources)
      text += "  resource '" + one.text + "' of " + name(one.before) + " before, of " + name(one.after) + " after\n";
    if (!edge.anew.empty()) text += "  may be initialised anew: " + names(edge.anew) + "\n";
    return text;
  }

  const std::string& node(std::size_t index) const { return report_.nodes[index].name; }

 private:
  std::string head(const ModeEdge& edge) const {
    if (edge.is_takeover) return "takeover, when " + name(report_.nodes[edge.to].primary.index) + " fails";
    const ModeWay way = edge.way();
    std::string text = way == ModeWay::kFast   ? "fast"
                       : way == ModeWay::kSlow ? "slow"
                                               : "slow, unless the constants keep their values";
    text += "; asked for by ";
    for (const ModeAsker& asker : edge.askers) text += asker_text(configuration_, asker) + ", ";
    return text + "an operator";
  }

  std::string constant(const ModeConstant& constant) const {
    return "of " + names(constant.users) + (constant.users.size() == 1 ? ", which stays" : ", which stay") +
           ": made by " + name(constant.before) + " before, by " + name(constant.after) + " after";
  }

  std::string names(const std::vector<std::size_t>& tasks) const {
    return join(tasks, ", ", [this](std::size_t task) { return name(task); });
  }

  std::string cpu(const CpuTransition& cpu) const {
    const std::string settled =
        cpu.settled == kNever || cpu.settled == Nanoseconds{}  // no job was released before
            ? ""
            : "; what was released before has ended " + time_text(cpu.settled) + " after the change";
    switch (cpu.guarantee) {
      case Guarantee::kYes: return "schedulable" + settled;
      case Guarantee::kNotStated: return "not judged whole: task " + task(cpu) + " has no budget";
      case Guarantee::kTooLong: return "not decided: too much to search for task " + task(cpu) + before(cpu);
      case Guarantee::kNo: break;
    }
    const Nanoseconds deadline = configuration_.spec().tasks[cpu.task.index].deadline;
    return "not schedulable: a cycle of task " + task(cpu) + " may take " +
           (cpu.takes == kNever ? "longer than its deadline of " + time_text(deadline)
                                : time_text(cpu.takes) + ", its deadline is " + time_text(deadline)) +
           before(cpu);
  }
  static std::string before(const CpuTransition& cpu) {
    return cpu.was_promised ? "" : "; neither is the configuration before, so nothing is lost";
  }
  std::string task(const CpuTransition& cpu) const { return "'" + name(cpu.task.index) + "'"; }
  const std::string& name(std::size_t task) const { return configuration_.tasks()[task].name; }

  const Configuration& configuration_;
  const ModeReport& report_;
};

}  // namespace

std::string modes_text(const Configuration& configuration, const ModeReport& report) {
  const ModeLines lines(configuration, report);
  std::string text;
  for (const ModeEdge& edge : report.edges) text += lines.edge(edge);
  if (report.edges.empty())
    return configuration.subsystem() + " has one configuration: there is nothing to switch to\n";
  if (report.by_operator.empty()) return text;
  text += "unreachable except by an operator:";
  for (const std::size_t set : report.by_operator) text += " " + lines.node(set);
  return text + "\n";
}

}  // namespace chimera::cli
