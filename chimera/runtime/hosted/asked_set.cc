// SPDX-License-Identifier: Apache-2.0
// Works out which tasks are ON when some are asked for and others are not wanted, and judges that set.
#include "chimera/runtime/hosted/asked_set.h"

#include <utility>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace chimera {
namespace {

std::vector<bool> flags_of(const TaskBits& tasks, const ApplicationSpec& spec) {
  std::vector<bool> flags(spec.tasks.size());
  for (std::size_t t = 0; t < flags.size(); ++t) flags[t] = tasks.has(TaskId(t));
  return flags;
}

std::vector<TaskId> ids_of(const std::vector<bool>& flags) {
  std::vector<TaskId> ids;
  for (std::size_t t = 0; t < flags.size(); ++t)
    if (flags[t]) ids.push_back(TaskId(t));
  return ids;
}

class SetMaker {
 public:
  SetMaker(const ApplicationSpec& spec, const TaskBits& on, const TaskLists& lists, bool on_one_cpu)
      : spec_(spec), variables_(spec), on_(flags_of(on, spec)), was_on_(on_), lists_(lists),
        plus_(ids_of(flags_of(lists.plus, spec))), on_one_cpu_(on_one_cpu) {
    rivals_.prepare(spec, memory_);
  }

  AskedSet make() {
    for (const TaskId task : plus_) {
      if (lists_.minus.has(task)) refuse("task " + name(task) + " cannot be both ON and OFF");
      on_[task.index] = true;
    }
    for (std::size_t t = 0; t < on_.size(); ++t)
      if (lists_.minus.has(TaskId(t))) on_[t] = false;
    displace();
    while (asked_ && complete()) {
    }
    asked_.tasks = bits_of(ids_of(on_));
    if (asked_ && set_of(spec_, asked_.tasks) == kNoSet) judge();
    return std::move(asked_);
  }

 private:
  std::string name(TaskId task) const { return "'" + std::string(spec_.tasks[task.index].name) + "'"; }
  /// The first refusal counts.
  void refuse(std::string why, std::string remedy = {}) {
    if (!asked_) return;
    asked_.why = std::move(why);
    asked_.remedy = std::move(remedy);
  }

  /// Turns OFF the tasks that produce the same variable as an asked task, or have its resource, unless asked for, too.
  void displace() {
    for (const Variable& variable : spec_.variables) {
      if (variable.producer([this](TaskId task) { return lists_.plus.has(task); }) == nullptr) continue;
      for (const PortOf& producer : variable.producers)
        if (!lists_.plus.has(producer.task)) on_[producer.task.index] = false;
    }
    for (const TaskId task : plus_)
      for (std::size_t t = 0; t < on_.size(); ++t)
        if (rivals_.are(task, TaskId(t)) && !lists_.plus.has(TaskId(t))) on_[t] = false;
  }

  /// Adds the only producer of a variable that has none; false: nothing is missing, or it cannot be mended. Inputs of
  /// standbys do not count here: a configuration meets them too (verify/rules/rule_links.cc).
  bool complete() {
    for (const Variable& variable : spec_.variables) {
      const auto is_on = [this](TaskId task) -> bool { return on_[task.index]; };
      if (set_fault(variable, is_on) != SetFault::kNoProducer) continue;
      std::vector<TaskId> may;
      for (const PortOf& producer : variable.producers)
        if (!lists_.minus.has(producer.task)) may.push_back(producer.task);
      if (may.size() == 1) {
        on_[may[0].index] = true;
        return true;
      }
      std::string names;
      for (const TaskId task : may) append_joined(names, " or ", name(task));
      const std::string lacks = std::string(variable.name) + " would have no producer";
      refuse(may.empty() ? lacks : lacks + ", and there is a choice: " + names,
             may.empty() ? "" : "`--on` with one of them");
      return false;
    }
    return false;
  }

  /// Verification has judged each configuration. A set that is none meets the same rules, and two more: its constants
  /// have one source, and no two of its tasks open one resource, which only a configuration can allow.
  void judge() {
    if (std::string fault = variables_.fault(on_, spec_.tasks); !fault.empty()) refuse(std::move(fault));
    if (asked_.tasks == TaskBits{}) refuse("no task would be ON");
    judge_loops();
    judge_constants();
    judge_resources();
    judge_load();
  }

  /// Takes away tasks that read no output without an initial value of a task that is left. What is left stands in a
  /// loop, or behind one. Verification names one loop by its variables (verify/rules/rule_loops.cc).
  void judge_loops() {
    std::vector<bool> before, left = on_;
    while (left != before) {
      before = std::exchange(left, std::vector<bool>(on_.size()));
      for (const Variable& variable : spec_.variables)
        for (const PortOf& from : variable.producers) {
          if (!before[from.task.index] || !spec_.port(CHIMERA_OUT_VAR, from)->value.empty()) continue;
          for (const PortOf& to : variable.consumers) left[to.task.index] = before[to.task.index];
        }
    }
    const std::string names = names_in(left, spec_.tasks);
    if (!names.empty()) refuse("a loop of data would have no initial value, among: " + names);
  }

  /// Which of several producers of a constant counts, a configuration says.
  void judge_constants() {
    for (const ConstantSpec& constant : spec_.constants) {
      if (constant.producers.size() < 2) continue;
      for (const PortOf& producer : constant.producers)
        if (on_[producer.task.index] != was_on_[producer.task.index])
          return refuse("which of its producers gives constant " + std::string(constant.name) +
                            ", only a configuration says, and these tasks are none",
                        "`chimera switch` with the name of a configuration");
    }
  }

  void judge_resources() {
    for (std::size_t a = 0; a < on_.size(); ++a)
      for (std::size_t b = a + 1; b < on_.size(); ++b)
        if (on_[a] && on_[b] && rivals_.are(TaskId(a), TaskId(b)))
          return refuse("tasks " + name(TaskId(a)) + " and " + name(TaskId(b)) + " open the same resource '" +
                            std::string(rivals_.resource(TaskId(a), TaskId(b))) + "'",
                        "one of the two with `--off`");
  }

  void judge_load() {
    const auto excess = excess_of(spec_, ids_of(on_), kMaxUtilisation, on_one_cpu_);
    if (excess) refuse(excess_text(spec_, *excess), "turn other tasks of that CPU OFF");
  }

  const ApplicationSpec& spec_;
  Variables variables_;
  HeapMemory memory_;
  Rivals rivals_;
  std::vector<bool> on_;
  const std::vector<bool> was_on_;
  const TaskLists& lists_;
  const std::vector<TaskId> plus_;
  const bool on_one_cpu_;
  AskedSet asked_;
};

}  // namespace

AskedSet asked_set(const ApplicationSpec& spec, const TaskBits& on, const TaskLists& lists, bool on_one_cpu) {
  return SetMaker(spec, on, lists, on_one_cpu).make();
}

std::string lists_text(const TaskLists& lists, const ApplicationSpec& spec) {
  std::string text;
  const auto add = [&](const char* word, const TaskBits& tasks) {
    if (tasks == TaskBits{}) return;
    append_joined(text, " ", word);
    text += " " + names_in(flags_of(tasks, spec), spec.tasks);
  };
  add("--on", lists.plus);
  add("--off", lists.minus);
  return text;
}

}  // namespace chimera
