// SPDX-License-Identifier: Apache-2.0
// Works out which tasks are ON when some are asked for and others are not wanted, and judges that set.
#include "chimera/runtime/hosted/asked_set.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/schedule/utilisation.h"

namespace chimera {
namespace {

std::vector<TaskId> ids_of(const TaskBits& tasks, const ApplicationSpec& spec) {
  std::vector<TaskId> ids;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t)
    if (tasks.has(TaskId(t))) ids.push_back(TaskId(t));
  return ids;
}

std::vector<bool> flags_of(const TaskBits& tasks, const ApplicationSpec& spec) {
  std::vector<bool> flags(spec.tasks.size());
  for (std::size_t t = 0; t < flags.size(); ++t) flags[t] = tasks.has(TaskId(t));
  return flags;
}

class SetMaker {
 public:
  SetMaker(const ApplicationSpec& spec, const TaskBits& on, const TaskLists& lists)
      : spec_(spec), variables_(spec), on_(flags_of(on, spec)), was_on_(on_), lists_(lists),
        plus_(ids_of(lists.plus, spec)) {
    rivals_.prepare(spec, memory_);
  }

  AskedSet make() {
    for (const TaskId task : plus_) {
      if (lists_.minus.has(task)) refuse("task " + name(task) + " cannot be both ON and OFF");
      on_[task.index] = true;
    }
    for (const TaskId task : ids_of(lists_.minus, spec_)) on_[task.index] = false;
    displace();
    while (asked_ && complete()) {
    }
    if (asked_) judge_links();
    if (asked_) judge_loops();
    if (asked_) judge_constants();
    if (asked_) judge_resources();
    if (asked_) judge_load();
    for (std::size_t t = 0; t < on_.size(); ++t)
      if (on_[t]) asked_.tasks.add(TaskId(t));
    return std::move(asked_);
  }

 private:
  std::string name(TaskId task) const { return "'" + std::string(spec_.tasks[task.index].name) + "'"; }
  void refuse(std::string why, std::string remedy = {}) {
    if (!asked_) return;
    asked_.why = std::move(why);
    asked_.remedy = std::move(remedy);
  }

  /// Turns OFF the tasks that produce the same variable as an asked task, or have its resource, unless asked for, too.
  void displace() {
    for (const Variable& variable : spec_.variables) {
      const auto is_asked = [this](const PortOf& p) { return lists_.plus.has(p.task); };
      if (std::ranges::none_of(variable.producers, is_asked)) continue;
      for (const PortOf& producer : variable.producers)
        if (!is_asked(producer)) on_[producer.task.index] = false;
    }
    for (const TaskId task : plus_)
      for (std::size_t t = 0; t < on_.size(); ++t)
        if (rivals_.are(task, TaskId(t)) && !lists_.plus.has(TaskId(t))) on_[t] = false;
  }

  /// Adds the only producer of a variable that has none; false: nothing is missing, or it cannot be mended.
  bool complete() {
    for (const Variable& variable : spec_.variables) {
      const auto is_on = [this](const PortOf& p) -> bool { return on_[p.task.index]; };
      const bool is_given = variable.operator_index != UINT32_MAX;
      if (set_fault(variable.producers, variable.consumers, is_given, is_on, is_on) != SetFault::kNoProducer) continue;
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

  void judge_links() {
    if (std::string fault = variables_.fault(on_, spec_.tasks); !fault.empty()) refuse(std::move(fault));
    if (std::ranges::find(on_, true) == on_.end()) refuse("no task would be ON");
  }

  /// An arc from a producer to a reader counts when the output has no initial value. What is left when tasks without an
  /// arc to them are taken away again and again stands in a loop, or behind one.
  void judge_loops() {
    std::vector<bool> left = on_;
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (std::size_t t = 0; t < left.size(); ++t) {
        if (!left[t] || is_fed(TaskId(t), left)) continue;
        left[t] = false;
        goes_on = true;
      }
    }
    std::string names;
    for (std::size_t t = 0; t < left.size(); ++t)
      if (left[t]) append_joined(names, " ", spec_.tasks[t].name);
    if (!names.empty()) refuse("a loop of data would have no initial value, among: " + names);
  }
  bool is_fed(TaskId reader, const std::vector<bool>& left) const {
    for (const PortSpec& in : spec_.tasks[reader.index].ports) {
      if (in.kind != CHIMERA_IN_VAR) continue;
      for (const PortOf& producer : spec_.variables[in.variable.index].producers)
        if (left[producer.task.index] && !has_initial(producer)) return true;
    }
    return false;
  }
  bool has_initial(const PortOf& output) const {
    std::uint32_t n = 0;
    for (const PortSpec& port : spec_.tasks[output.task.index].ports)
      if (port.kind == CHIMERA_OUT_VAR && n++ == output.index) return !port.value.empty();
    return false;
  }

  /// Which of several producers of a constant counts, a configuration says.
  void judge_constants() {
    TaskBits target;
    for (std::size_t t = 0; t < on_.size(); ++t)
      if (on_[t]) target.add(TaskId(t));
    if (set_of(spec_, target) != kNoSet) return;
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
    for (const RtpuSpec& one : spec_.rtpus) {
      double sum = 0;
      for (std::size_t t = 0; t < on_.size(); ++t)
        if (on_[t] && spec_.rtpus[spec_.tasks[t].rtpu.index].cpu == one.cpu) sum += load_of(spec_.tasks[t]);
      if (!is_beyond(sum)) continue;
      char text[120];
      std::snprintf(text, sizeof text, "the budgets would take %.3f of CPU %u; expected at most %.2f", sum, one.cpu,
                    kMaxUtilisation);
      return refuse(text, "turn other tasks of that CPU OFF");
    }
  }

  const ApplicationSpec& spec_;
  Variables variables_;
  HeapMemory memory_;
  Rivals rivals_;
  std::vector<bool> on_;
  const std::vector<bool> was_on_;
  const TaskLists& lists_;
  const std::vector<TaskId> plus_;
  AskedSet asked_;
};

}  // namespace

AskedSet asked_set(const ApplicationSpec& spec, const TaskBits& on, const TaskLists& lists) {
  return SetMaker(spec, on, lists).make();
}

std::string lists_text(const TaskLists& lists, const ApplicationSpec& spec) {
  std::string text;
  const auto add = [&](const char* word, const TaskBits& tasks) {
    if (tasks == TaskBits{}) return;
    append_joined(text, " ", word);
    for (const TaskId task : ids_of(tasks, spec)) text += " " + std::string(spec.tasks[task.index].name);
  };
  add("--on", lists.plus);
  add("--off", lists.minus);
  return text;
}

}  // namespace chimera
