// SPDX-License-Identifier: Apache-2.0
// Computes the order in which the tasks of a configuration go ON, and cuts its loops.
#include <algorithm>
#include <bitset>
#include <map>
#include <utility>
#include <vector>

#include "chimera/base/assert.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

/// The kinds of places where a loop may be cut, best first. A link that only `on` reads is no part of a loop of cycles;
/// it is cut last, so that its producer goes ON first.
enum class Cut : std::uint8_t { kByDescription, kByComponent, kNot, kReadByOn };

/// `from` produces `variable`, `to` reads it.
struct Arc {
  std::size_t from, to;  ///< positions in the set
  std::size_t variable;
  Cut cut;
};

/// One bit for each task of a set: a description has at most kMaxTasks.
using Tasks = std::bitset<kMaxTasks>;

/// The arcs of one variable from one producer. One cut removes those within one loop.
struct VariableArcs {
  std::pair<Cut, std::size_t> rank;  ///< the variable by its name; the least is cut first
  Tasks consumers;                   ///< positions in the set, without those that were cut
};

/// True if `from` reaches all of `among` inside `among`.
bool reaches_all(const std::vector<Tasks>& next, std::size_t from, const Tasks& among) {
  Tasks seen, edge;
  seen.set(from);
  edge.set(from);
  while (seen != among && edge.any()) {
    const std::size_t at = edge._Find_first();
    edge.reset(at);
    const Tasks found = next[at] & among & ~seen;
    seen |= found;
    edge |= found;
  }
  return seen == among;
}

/// Calls `tell(Tasks)` once for each strong component of the tasks `among`, along `next` and back along `previous`. Its
/// time is proportional to the tasks, times the words of a bit set, because it follows whole sets at once.
template <class Tell>
void for_each_component(const std::vector<Tasks>& next, const std::vector<Tasks>& previous, const Tasks& among,
                        const Tell& tell) {
  std::vector<std::size_t> ended;  // in the order in which a walk along `next` left them
  std::vector<std::size_t> path;
  Tasks unseen = among;
  for (std::size_t root = unseen._Find_first(); root < kMaxTasks; root = unseen._Find_first()) {
    path.push_back(root);
    unseen.reset(root);
    while (!path.empty()) {
      const std::size_t to = (next[path.back()] & unseen)._Find_first();
      if (to < kMaxTasks) {
        path.push_back(to);
        unseen.reset(to);
      } else {
        ended.push_back(path.back());
        path.pop_back();
      }
    }
  }
  Tasks left = among;
  for (std::size_t i = ended.size(); i-- > 0;) {
    if (!left[ended[i]]) continue;
    Tasks component, edge;
    edge.set(ended[i]);
    while (edge.any()) {
      const std::size_t at = edge._Find_first();
      component.set(at);
      edge.reset(at);
      left.reset(at);
      edge |= previous[at] & left;
    }
    tell(component);
  }
}

class SetOrder {
 public:
  /// `by_name[v]` is the place of variable v in the order of names.
  SetOrder(Model& model, SetModel& set, const std::vector<std::size_t>& by_name)
      : model_(model),
        set_(set),
        by_name_(by_name),
        position_(model.tasks.size(), kMaxTasks),
        links_(set.tasks.size()),
        first_link_(set.tasks.size(), 0),
        next_(set.tasks.size()),
        previous_(set.tasks.size()),
        component_(set.tasks.size()),
        between_(set.tasks.size() * set.tasks.size(), 0) {
    for (std::size_t i = 0; i < set.tasks.size(); ++i) {
      position_[set.tasks[i].index] = i;
      hardware_[i] = task(i).has_resource() && !task(i).has_inputs();
    }
    for (std::size_t v = 0; v < model.variables.size(); ++v) add_arcs(v);
  }

  void report_loops() {
    std::vector<std::vector<Arc>> bare(set_.tasks.size());  // by producer
    std::vector<Tasks> next(set_.tasks.size()), previous(set_.tasks.size());
    for (const Arc& arc : arcs_) {
      if (arc.cut != Cut::kNot) continue;
      bare[arc.from].push_back(arc);
      next[arc.from].set(arc.to);
      previous[arc.to].set(arc.from);
    }
    std::vector<Tasks> loop_of(set_.tasks.size());
    for_each_component(next, previous, all(), [&](const Tasks& component) { assign(loop_of, component); });
    Tasks told;
    for (const Arc& arc : arcs_) {
      const Tasks& component = loop_of[arc.from];
      if (arc.cut != Cut::kNot || !component[arc.to] || told[arc.from]) continue;
      told |= component;
      report(loop_through(bare, component, arc));
    }
  }

  void order() {
    rank_links();
    left_ = looping_ = all();
    for_each_component(next_, previous_, left_, [&](const Tasks& component) { assign(component_, component); });
    look_at(left_);
    while (left_.any()) {
      if (ready_.none()) {
        cut_a_loop();
        continue;
      }
      // Hardware inputs first, then the order of the description.
      const Tasks first = ready_ & hardware_;
      const std::size_t next = (first.any() ? first : ready_)._Find_first();
      ready_.reset(next);
      left_.reset(next);
      look_at(next_[next]);
      set_.order.push_back(set_.tasks[next]);
    }
  }

 private:
  const TaskModel& task(std::size_t at) const { return model_.tasks[set_.tasks[at].index]; }

  Tasks all() const {
    Tasks tasks;
    for (std::size_t i = 0; i < set_.tasks.size(); ++i) tasks.set(i);
    return tasks;
  }

  static void assign(std::vector<Tasks>& component_of, const Tasks& component) {
    for (std::size_t i = component._Find_first(); i < kMaxTasks; i = component._Find_next(i))
      component_of[i] = component;
  }

  void add_arcs(std::size_t index) {
    const VariableModel& variable = model_.variables[index];
    if (variable.is_constant) return;
    for (const PortRef producer : variable.producers) {
      const std::size_t from = position_[producer.task];
      if (from == kMaxTasks) continue;
      const LinkedPort& port = model_.port(producer);
      const Cut cut = port.own != nullptr               ? Cut::kByDescription
                      : !port.declared->initial.empty() ? Cut::kByComponent
                                                        : Cut::kNot;
      add_link(from, index, cut, false);
      add_link(from, index, Cut::kReadByOn, true);
    }
  }

  /// Adds the arcs to the consumers that read the variable in `on` only, or to the others.
  void add_link(std::size_t from, std::size_t index, Cut cut, bool is_read_by_on) {
    VariableArcs link{{cut, by_name_[index]}, {}};
    for (const PortRef consumer : model_.variables[index].consumers) {
      const std::size_t to = position_[consumer.task];
      if (to == kMaxTasks || may_be_left_out(*model_.port(consumer).declared) != is_read_by_on) continue;
      arcs_.push_back({from, to, index, cut});
      if (!link.consumers[to]) ++between_[from * set_.tasks.size() + to];
      link.consumers.set(to);
    }
    if (link.consumers.none()) return;
    next_[from] |= link.consumers;
    for (std::size_t to = link.consumers._Find_first(); to < kMaxTasks; to = link.consumers._Find_next(to))
      previous_[to].set(from);
    links_[from].push_back(link);
  }

  /// Sorts the links of each task, the best cut first.
  void rank_links() {
    for (std::vector<VariableArcs>& of : links_)
      std::stable_sort(of.begin(), of.end(),
                       [](const VariableArcs& a, const VariableArcs& b) { return a.rank < b.rank; });
  }

  /// The shortest loop that starts with `first` inside `component`; `arcs` by producer.
  std::vector<Arc> loop_through(const std::vector<std::vector<Arc>>& arcs, const Tasks& component,
                                const Arc& first) const {
    std::vector<const Arc*> by(set_.tasks.size(), nullptr);
    std::vector<std::size_t> queue{first.to};
    for (std::size_t i = 0; i < queue.size() && queue[i] != first.from; ++i)
      for (const Arc& arc : arcs[queue[i]])
        if (component[arc.to] && arc.to != first.to && by[arc.to] == nullptr) {
          by[arc.to] = &arc;
          queue.push_back(arc.to);
        }
    std::vector<Arc> loop;
    for (std::size_t at = first.from; at != first.to; at = by[at]->from) loop.push_back(*by[at]);
    loop.push_back(first);
    std::reverse(loop.begin(), loop.end());
    return loop;
  }

  void report(const std::vector<Arc>& loop) {
    std::string path = "'" + task(loop[0].from).name() + "'";
    for (const Arc& arc : loop) path += " -" + model_.variables[arc.variable].name + "-> '" + task(arc.to).name() + "'";
    const LinkedPort& port = port_of(loop.back());
    model_.error(
        "loop-without-initial", Spot(task(loop[0].from).draft->name.at, port_of(loop[0])).in(set_),
        "the loop " + path + " in configuration '" + set_.name + "' has no initial value", {},
        "an initial value on one of its variables", {},
        "give one: initial: {" + port.declared->name + ": ...} of task '" + task(loop.back().from).name() + "'");
  }

  const LinkedPort& port_of(const Arc& arc) const {
    for (const PortRef ref : model_.variables[arc.variable].producers)
      if (ref.task == set_.tasks[arc.from].index) return model_.port(ref);
    CHIMERA_ASSERT(false);
    return model_.tasks[0].ports[0];
  }

  /// Marks the tasks of `tasks` without a waiting producer as ready.
  void look_at(const Tasks& tasks) {
    for (std::size_t i = tasks._Find_first(); i < kMaxTasks; i = tasks._Find_next(i))
      if ((previous_[i] & left_).none()) ready_.set(i);
  }

  /// The first link of `from` that is part of a loop. nullptr: none is, and none will be, because components only
  /// become smaller.
  const VariableArcs* best_link(std::size_t from) {
    std::size_t& at = first_link_[from];
    while (at < links_[from].size() && (links_[from][at].consumers & component_[from]).none()) ++at;
    return at < links_[from].size() ? &links_[from][at] : nullptr;
  }

  /// True if a task outside of it that is not placed either feeds it.
  bool is_fed(const Tasks& component) const {
    const Tasks outside = left_ & ~component;
    for (std::size_t i = component._Find_first(); i < kMaxTasks; i = component._Find_next(i))
      if ((previous_[i] & outside).any()) return true;
    return false;
  }

  /// Cuts one variable in a loop that waits only for itself.
  void cut_a_loop() {
    const VariableArcs* best = nullptr;
    std::size_t from = kMaxTasks;
    for (Tasks todo = looping_ &= left_; todo.any();) {
      const Tasks component = component_[todo._Find_first()];
      todo &= ~component;
      if (is_fed(component)) continue;
      for (std::size_t i = component._Find_first(); i < kMaxTasks; i = component._Find_next(i)) {
        const VariableArcs* link = best_link(i);
        if (link == nullptr) looping_.reset(i);
        if (link == nullptr || (best != nullptr && link->rank >= best->rank)) continue;
        best = link;
        from = i;
      }
    }
    CHIMERA_ASSERT(best != nullptr);
    cut(from, links_[from][first_link_[from]]);
  }

  void cut(std::size_t from, VariableArcs& link) {
    const Tasks gone = link.consumers & component_[from];
    link.consumers &= ~gone;
    for (std::size_t to = gone._Find_first(); to < kMaxTasks; to = gone._Find_next(to)) {
      if (--between_[from * set_.tasks.size() + to] > 0) continue;
      next_[from].reset(to);
      previous_[to].reset(from);
    }
    look_at(gone);
    split(from);
  }

  /// Splits the component of `from` after a cut behind it. Usually only that task leaves it, or none does.
  void split(std::size_t from) {
    Tasks rest = component_[from];
    if ((next_[from] & rest).none() && rest.count() > 1) {
      component_[from].reset();
      component_[from].set(from);
      rest.reset(from);
    }
    const std::size_t any = rest._Find_first();
    if (reaches_all(next_, any, rest) && reaches_all(previous_, any, rest)) return assign(component_, rest);
    for_each_component(next_, previous_, rest, [&](const Tasks& part) { assign(component_, part); });
  }

  Model& model_;
  SetModel& set_;
  const std::vector<std::size_t>& by_name_;
  std::vector<std::size_t> position_;  // of a task in the set; kMaxTasks: not in the set
  std::vector<Arc> arcs_;
  std::vector<std::vector<VariableArcs>> links_;  // by producer
  std::vector<std::size_t> first_link_;   // of these the first that may be part of a loop
  std::vector<Tasks> next_, previous_;    // consumers and producers, without cut arcs
  std::vector<Tasks> component_;          // of tasks that are not placed
  std::vector<std::uint16_t> between_;    // links from one task to another, without cut ones
  Tasks hardware_;                        // hardware inputs, which come first
  Tasks left_, ready_;                    // not placed yet; those of them without a waiting producer
  Tasks looping_;                         // tasks whose outputs may be part of a loop
};

}  // namespace

void order_sets(Model& model) {
  std::vector<std::size_t> by_name(model.variables.size());
  std::size_t place = 0;
  for (const auto& [name, index] : model.variable_index) by_name[index] = place++;
  std::map<std::vector<TaskId>, const SetModel*> ordered;  // key: tasks, because the order depends only on them
  for (SetModel& set : model.sets) {
    SetOrder order(model, set, by_name);
    order.report_loops();
    const auto [found, is_new] = ordered.emplace(set.tasks, &set);
    if (is_new)
      order.order();
    else
      set.order = found->second->order;
  }
}

}  // namespace chimera
