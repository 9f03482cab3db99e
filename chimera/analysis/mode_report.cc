// SPDX-License-Identifier: Apache-2.0
// Finds the tasks that ask for each configuration. Judges the switch from each configuration, also with a standby in
// the place of its primary, to each other.
#include "chimera/analysis/mode_report.h"

#include <algorithm>
#include <optional>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/asked_set.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/plan/constant_choice.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace chimera {
namespace {

/// Something of a task that asks for the set of that number, or for the one that lists of tasks lead to.
struct ModeWish {
  ModeAsker asker;
  std::size_t set = 0;
  TaskLists lists;
};

class ModeWriter {
 public:
  ModeWriter(const Configuration& configuration, const Library& library)
      : configuration_(configuration), library_(library), statuses_(configuration.tasks().size()) {
    schedule_.prepare(configuration.spec(), memory_);
    planner_.prepare(configuration.spec(), memory_);
    users_.prepare(configuration.spec(), memory_);
    rivals_.prepare(configuration.spec(), memory_);
  }

  ModeReport write() {
    for (std::size_t t = 0; t < configuration_.tasks().size(); ++t) find_wishes(t);
    find_nodes();
    const std::size_t n = configuration_.sets().size();
    for (std::size_t from = 0; from < report_.nodes.size(); ++from) {
      if (report_.nodes[from].standby.is_valid()) report_.edges.push_back(takeover(from));
      for (std::size_t to = 0; to < report_.nodes.size(); ++to)
        if (from != to) add_change(from, to);
    }
    for (std::size_t set = 0; set < n; ++set)
      if (set != configuration_.start() && !is_asked_for(set)) report_.by_operator.push_back(set);
    for (const ModeWish& wish : wishes_) wish.lists.are_there() ? warn_of_lists(wish) : warn(wish);
    for (const ModeEdge& edge : report_.edges)
      if (edge.way() == ModeWay::kSlowUnlessSame || !edge.resources.empty()) warn(edge);
    return std::move(report_);
  }

 private:
  void find_nodes() {
    const auto sets = configuration_.sets();
    const auto name = [&](TaskId task) { return configuration_.tasks()[task.index].name; };
    for (std::size_t s = 0; s < sets.size(); ++s)
      report_.nodes.push_back({.name = sets[s].name, .set = s, .primary = {}, .standby = {}, .tasks = sets[s].order});
    for (std::size_t s = 0; s < sets.size(); ++s) {
      for (const StandbySpec& pair : configuration_.spec().standbys) {
        if (!has(s, pair.primary.index)) continue;
        ModeNode made{.name = sets[s].name + " with " + name(pair.standby) + " for " + name(pair.primary),
                      .set = s, .primary = pair.primary, .standby = pair.standby, .tasks = sets[s].order};
        std::ranges::replace(made.tasks, pair.primary, pair.standby);
        report_.nodes.push_back(std::move(made));
      }
    }
    const std::size_t n = report_.nodes.size();
    for (const ModeWish& wish : wishes_)
      for (std::size_t from = 0; wish.lists.are_there() && from < n; ++from) follow_lists(wish, from);
  }

  /// Adds the set that the lists lead to, if it is none of the nodes.
  void follow_lists(const ModeWish& wish, std::size_t from) {
    if (!has(from, wish.asker.task)) return;
    const ApplicationSpec& spec = configuration_.spec();
    const AskedSet asked = asked_set(spec, bits_of(report_.nodes[from].tasks), wish.lists);
    const auto is_it = [&](const ModeNode& node) { return bits_of(node.tasks) == asked.tasks; };
    if (!asked || std::ranges::any_of(report_.nodes, is_it)) return;
    ModeNode made{.name = report_.nodes[from].name + " " + lists_text(wish.lists, spec),
                  .set = report_.nodes[from].set, .primary = {}, .standby = {}, .tasks = {}};
    for (const TaskId task : spec.on_order)
      if (asked.tasks.has(task)) made.tasks.push_back(task);
    report_.nodes.push_back(std::move(made));
  }

  void find_wishes(std::size_t task) {
    const DraftTask& draft = configuration_.draft().tasks[task];
    const auto add = [&](const Word& name, ModeCause cause) {
      if (const auto set = find_set(name.text)) wishes_.push_back({{cause, task, {}}, *set, {}});
    };
    if (draft.on_miss) add(draft.on_miss->configuration, ModeCause::kMiss);
    if (draft.on_overrun) add(draft.on_overrun->configuration, ModeCause::kOverrun);
    if (draft.on_fault) add(draft.on_fault->configuration, ModeCause::kFault);
    const LibraryEntry* const entry = library_.find(configuration_.tasks()[task].component);
    if (entry == nullptr) return;
    const ApplicationSpec& spec = configuration_.spec();
    const std::span<const ConfiguredPort> ports = configuration_.tasks()[task].ports;
    for (const PortSpec& port : spec.tasks[task].ports) {
      if (port.kind != CHIMERA_IN_CONST || !entry->descriptor.ports[port.declared].names_configuration) continue;
      const auto bytes = port.constant.is_valid() ? spec.constants[port.constant.index].value : port.value;
      for (std::size_t at = 0; at + port.element_bytes <= bytes.size(); at += port.element_bytes) {
        const auto* start = reinterpret_cast<const char*>(bytes.data() + at);
        const std::string_view text(start, ::strnlen(start, port.element_bytes));
        const ModeAsker asker{ModeCause::kConstant, task, name_of(ports, port), port.instance};
        if (const auto set = find_set(text)) wishes_.push_back({asker, *set, {}});
        else if (const TaskLists lists = lists_of(text); lists.are_there()) wishes_.push_back({asker, 0, lists});
      }
    }
  }

  static std::string name_of(std::span<const ConfiguredPort> ports, const PortSpec& spec) {
    for (const ConfiguredPort& port : ports)
      if (port.declared == spec.declared && port.instance == spec.instance) return port.name;
    return {};
  }

  /// None of a text that is no lists, such as the default of a component, which no rule has read.
  TaskLists lists_of(std::string_view text) const {
    const auto tasks = configuration_.tasks();
    const auto find = [&](std::string_view name) {
      const auto found = std::ranges::find(tasks, name, &ConfiguredTask::name);
      return found == tasks.end() ? TaskId{} : TaskId(static_cast<std::size_t>(found - tasks.begin()));
    };
    TaskLists lists;
    return has_lists(text) && !read_lists(text, find, lists) ? lists : TaskLists();
  }

  std::optional<std::size_t> find_set(std::string_view name) const {
    const auto sets = configuration_.sets();
    const auto found = std::ranges::find(sets, name, &ConfiguredSet::name);
    if (name.empty() || found == sets.end()) return std::nullopt;
    return static_cast<std::size_t>(found - sets.begin());
  }

  bool has(std::size_t node, std::size_t task) const {
    return std::ranges::count(report_.nodes[node].tasks, TaskId(task)) != 0;
  }
  bool is_asked_for(std::size_t set) const {
    return std::ranges::any_of(report_.edges,
                               [&](const ModeEdge& edge) { return edge.to == set && !edge.askers.empty(); });
  }

  ModeEdge takeover(std::size_t to) {
    ModeEdge made;
    made.from = report_.nodes[to].set;
    made.to = to;
    made.is_takeover = true;
    judge_deadlines(made);
    return made;
  }

  /// Only lists of a task lead to a node that is no configuration. Constants keep their producers there: asked_set().
  void add_change(std::size_t from, std::size_t to) {
    const bool is_set = to < configuration_.sets().size();
    ModeEdge made;
    made.from = from;
    made.to = to;
    for (const ModeWish& wish : wishes_)
      if (has(from, wish.asker.task) && leads_to(wish, from, to)) made.askers.push_back(wish.asker);
    if (!is_set && made.askers.empty()) return;
    judge_deadlines(made);
    if (is_set) find_constants(made);
    find_resources(made);
    report_.edges.push_back(std::move(made));
  }

  bool leads_to(const ModeWish& wish, std::size_t from, std::size_t to) const {
    if (!wish.lists.are_there()) return wish.set == to;
    const AskedSet asked = asked_set(configuration_.spec(), bits_of(report_.nodes[from].tasks), wish.lists);
    return asked && asked.tasks == bits_of(report_.nodes[to].tasks);
  }

  void judge_deadlines(ModeEdge& edge) {
    TaskBits after;
    for (std::size_t t = 0; t < statuses_.size(); ++t) {
      statuses_[t].state = has(edge.from, t) ? State::kOn : State::kOff;
      if (has(edge.to, t)) after.add(TaskId(t));
    }
    schedule_.consider(statuses_, after);
    for (std::size_t r = 0; r < configuration_.rtpus().size(); ++r) {
      if (!schedule_.is_first_of_cpu(RtpuId(r))) continue;
      const CpuTransition cpu = schedule_.on_cpu_of(RtpuId(r));
      if (cpu.is_moved) edge.cpus.push_back(cpu);
    }
  }

  /// Requires: judge_deadlines() of it has just been asked for.
  void find_constants(ModeEdge& edge) {
    const auto in_force = static_cast<std::uint32_t>(report_.nodes[edge.from].set);
    SwitchPlan plan;
    if (!planner_.plan(static_cast<std::uint32_t>(edge.to), statuses_, plan)) return;
    for (const TaskId user : users_.find(plan, in_force, nullptr))
      if (std::ranges::count(plan.staying, user) != 0) edge.anew.push_back(user.index);
    if (edge.anew.empty()) return;
    for (std::uint32_t c = 0; c < configuration_.spec().constants.size(); ++c) {
      ModeConstant made = constant(ConstantId(c), plan, in_force);
      if (!made.users.empty()) edge.constants.push_back(std::move(made));
    }
  }

  void find_resources(ModeEdge& edge) {
    for (const TaskId after : report_.nodes[edge.to].tasks)
      for (const TaskId before : report_.nodes[edge.from].tasks)
        if (rivals_.are(before, after))
          edge.resources.push_back({std::string(rivals_.resource(before, after)), before.index, after.index});
  }

  /// Without those that a task makes which stays: they follow from others.
  ModeConstant constant(ConstantId id, const SwitchPlan& plan, std::uint32_t in_force) {
    ModeConstant made{.name = std::string(configuration_.spec().constants[id.index].name),
                      .before = 0, .after = 0, .users = {}};
    for (const TaskId user : plan.staying) {
      if (!users_.is_another(id, user, plan, in_force, nullptr)) continue;
      const std::size_t before = maker(id, user, in_force), after = maker(id, user, plan.after);
      if (before == after) continue;
      made.before = before;
      made.after = after;
      made.users.push_back(user.index);
    }
    return made;
  }

  std::size_t maker(ConstantId constant, TaskId user, std::uint32_t set) const {
    const ApplicationSpec& spec = configuration_.spec();
    return spec.constants[constant.index].producers[producer_for(spec, constant, user, set)].task.index;
  }

  /// Warns of lists that lead to no legal set from a configuration in which the task asks for them.
  void warn_of_lists(const ModeWish& wish) {
    const ApplicationSpec& spec = configuration_.spec();
    for (std::size_t from = 0; from < configuration_.sets().size(); ++from) {
      if (!has(from, wish.asker.task)) continue;
      const AskedSet asked = asked_set(spec, bits_of(report_.nodes[from].tasks), wish.lists);
      if (!asked)
        report_.warnings.push_back(asker_text(configuration_, wish.asker) + " asks for '" +
                                   lists_text(wish.lists, spec) + "': from '" + report_.nodes[from].name +
                                   "' that is refused: " + asked.text());
    }
  }

  /// Warns of a task that asks, by a reaction, for a configuration that contains the task itself.
  void warn(const ModeWish& wish) {
    if (!wish.asker.is_reaction() || !has(wish.set, wish.asker.task)) return;
    const bool leaves_any = std::ranges::any_of(report_.edges, [&](const ModeEdge& edge) {
      return edge.to == wish.set && has(edge.from, wish.asker.task);
    });
    if (!leaves_any) return;
    const std::string text = asker_text(configuration_, wish.asker) + " asks for configuration '" +
                             configuration_.sets()[wish.set].name + "', which contains the task itself: ";
    report_.warnings.push_back(text + (wish.asker.cause == ModeCause::kFault
                                           ? "in ERROR it cannot be part of it, so the switch is refused"
                                           : "it goes on there as it is"));
  }

  /// Warns of reactions whose switch goes the slow way, under the flag; some only if the values of constants differ.
  void warn(const ModeEdge& edge) {
    const auto name = [](const ModeConstant& constant) { return in_quotes(constant.name); };
    const std::string names = join(edge.constants, ", ", name);
    const std::string unless = "unless the values are the same of " +
                               std::string(edge.constants.size() == 1 ? "constant " : "constants ") + names;
    const std::string why = edge.resources.empty() ? unless : "because resource '" + edge.resources[0].text +
                                                                  "' changes hands";
    for (const ModeAsker& asker : edge.askers) {
      if (!asker.is_reaction()) continue;
      report_.warnings.push_back(asker_text(configuration_, asker) + " asks for configuration '" +
                                 report_.nodes[edge.to].name + "': from '" + report_.nodes[edge.from].name +
                                 "' that is slow, under the flag, " + why);
    }
  }

  const Configuration& configuration_;
  const Library& library_;
  HeapMemory memory_;
  SwitchSchedule schedule_;
  SwitchPlanner planner_;
  ConstantUsers users_;
  Rivals rivals_;
  std::vector<TaskStatus> statuses_;
  std::vector<ModeWish> wishes_;
  ModeReport report_;
};

}  // namespace

ModeWay ModeEdge::way() const noexcept {
  if (is_takeover) return ModeWay::kTakeover;
  if (breaks_promise() || !resources.empty()) return ModeWay::kSlow;
  return anew.empty() ? ModeWay::kFast : ModeWay::kSlowUnlessSame;
}

bool ModeEdge::breaks_promise() const noexcept {
  return !is_takeover &&
         std::ranges::any_of(cpus, [](const CpuTransition& cpu) { return cpu.is_lost() && cpu.was_promised; });
}

bool ModeEdge::has_reaction() const noexcept { return std::ranges::any_of(askers, &ModeAsker::is_reaction); }

bool ModeReport::is_accepted() const noexcept {
  return std::ranges::none_of(edges, [](const ModeEdge& edge) { return edge.breaks_promise() && edge.has_reaction(); });
}

ModeReport mode_report(const Configuration& configuration, const Library& library) {
  return ModeWriter(configuration, library).write();
}

std::string asker_text(const Configuration& configuration, const ModeAsker& asker) {
  const std::string& task = configuration.tasks()[asker.task].name;
  switch (asker.cause) {
    case ModeCause::kMiss: return "on_miss of " + task;
    case ModeCause::kOverrun: return "on_overrun of " + task;
    case ModeCause::kFault: return "on_fault of " + task;
    case ModeCause::kConstant: break;
  }
  const auto& sequence = configuration.draft().sequence;
  if (sequence && task == kSequenceTask) return sequence->say(sequence->steps[asker.instance]) + " of the sequence";
  return "constant " + asker.constant + " of " + task;
}

const char* schedulable_word(Guarantee guarantee) noexcept {
  switch (guarantee) {
    case Guarantee::kYes: return "yes";
    case Guarantee::kNo: return "no";
    case Guarantee::kNotStated: return "not-stated";
    case Guarantee::kTooLong: return "not-decided";
  }
  return "?";
}

}  // namespace chimera
