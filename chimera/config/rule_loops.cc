// SPDX-License-Identifier: Apache-2.0
// The order in which the tasks of a configuration go ON, and the loops that it has to cut.
#include <algorithm>
#include <limits>

#include "chimera/base/assert.h"
#include "chimera/config/rules.h"

namespace chimera {
namespace {

/// Where a loop may be cut, best first.
enum class Cut : std::uint8_t { kByDescription, kByComponent, kNot };

/// `from` produces `variable`, `to` reads it.
struct Arc {
  std::size_t from, to;  ///< positions in the set
  std::size_t variable;
  Cut cut;
};

class SetOrder {
 public:
  SetOrder(Model& model, SetModel& set) : model_(model), set_(set), component_(set.tasks.size(), 0) {
    for (std::size_t v = 0; v < model.variables.size(); ++v) add_arcs(v);
  }

  void report_loops() {
    std::vector<Arc> bare;
    for (const Arc& arc : arcs_)
      if (arc.cut == Cut::kNot) bare.push_back(arc);
    find_components(bare, std::vector<bool>(set_.tasks.size(), false));
    std::vector<bool> told(set_.tasks.size(), false);
    for (const Arc& arc : bare) {
      const std::size_t component = component_[arc.from];
      if (component != component_[arc.to] || told[component]) continue;
      told[component] = true;
      report(loop_through(bare, arc));
    }
  }

  void order() {
    std::vector<bool> placed(set_.tasks.size(), false);
    while (set_.order.size() < set_.tasks.size()) {
      const std::size_t next = next_ready(placed);
      if (next == set_.tasks.size()) {
        cut_a_loop(placed);
        continue;
      }
      placed[next] = true;
      set_.order.push_back(TaskId(set_.tasks[next]));
    }
  }

 private:
  const TaskModel& task(std::size_t at) const { return model_.tasks[set_.tasks[at]]; }

  std::size_t position(std::size_t task) const {
    return static_cast<std::size_t>(std::find(set_.tasks.begin(), set_.tasks.end(), task) - set_.tasks.begin());
  }

  void add_arcs(std::size_t index) {
    const VariableModel& variable = model_.variables[index];
    if (variable.is_constant) return;
    for (const PortRef producer : variable.producers) {
      if (!set_.has(producer.task)) continue;
      const LinkedPort& port = model_.port(producer);
      const Cut cut = port.own != nullptr               ? Cut::kByDescription
                      : !port.declared->initial.empty() ? Cut::kByComponent
                                                        : Cut::kNot;
      for (const PortRef consumer : variable.consumers)
        if (set_.has(consumer.task))
          arcs_.push_back({position(producer.task), position(consumer.task), index, cut});
    }
  }

  /// component_[i] = the same number for all that reach each other along `arcs`, `placed` ones left out (Tarjan,
  /// with a stack of our own: a chain may be 256 tasks long).
  void find_components(const std::vector<Arc>& arcs, const std::vector<bool>& placed);

  /// The shortest loop that starts with `first`.
  std::vector<Arc> loop_through(const std::vector<Arc>& arcs, const Arc& first) const {
    std::vector<const Arc*> by(set_.tasks.size(), nullptr);
    std::vector<std::size_t> queue{first.to};
    for (std::size_t i = 0; i < queue.size() && queue[i] != first.from; ++i)
      for (const Arc& arc : arcs)
        if (arc.from == queue[i] && arc.to != first.to && by[arc.to] == nullptr) {
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
    for (const Arc& arc : loop)
      path += " -" + model_.variables[arc.variable].name + "-> '" + task(arc.to).name() + "'";
    const LinkedPort& port = port_of(loop.back());
    model_.error(
        "loop-without-initial", task(loop[0].from).draft->name.at,
        "the loop " + path + " in configuration '" + set_.name + "' has no initial value", {},
        "an initial value on one of its variables", {},
        "give one: initial: {" + port.declared->name + ": ...} of task '" + task(loop.back().from).name() + "'");
  }

  const LinkedPort& port_of(const Arc& arc) const {
    for (const PortRef ref : model_.variables[arc.variable].producers)
      if (ref.task == set_.tasks[arc.from]) return model_.port(ref);
    CHIMERA_ASSERT(false);
    return model_.tasks[0].ports[0];
  }

  /// Of those that wait for nobody the first: hardware inputs first, then the order of the description.
  std::size_t next_ready(const std::vector<bool>& placed) const {
    std::vector<bool> waits(set_.tasks.size(), false);
    for (const Arc& arc : arcs_)
      if (!placed[arc.from]) waits[arc.to] = true;
    std::size_t best = set_.tasks.size();
    for (std::size_t i = 0; i < set_.tasks.size(); ++i) {
      if (placed[i] || waits[i]) continue;
      const bool is_input = task(i).has_resource() && !task(i).has_inputs();
      if (is_input) return i;
      if (best == set_.tasks.size()) best = i;
    }
    return best;
  }

  /// Takes one variable out of a loop that waits for nothing but itself.
  void cut_a_loop(const std::vector<bool>& placed) {
    find_components(arcs_, placed);
    std::vector<bool> fed(set_.tasks.size(), false);  // by another component that is not placed either
    for (const Arc& arc : arcs_)
      if (!placed[arc.from] && component_[arc.from] != component_[arc.to]) fed[component_[arc.to]] = true;
    const Arc* best = nullptr;
    for (const Arc& arc : arcs_) {
      if (placed[arc.from] || component_[arc.from] != component_[arc.to] || fed[component_[arc.from]]) continue;
      const auto rank = [this](const Arc& a) { return std::pair(a.cut, model_.variables[a.variable].name); };
      if (best == nullptr || rank(arc) < rank(*best)) best = &arc;
    }
    CHIMERA_ASSERT(best != nullptr);
    const std::size_t variable = best->variable, component = component_[best->from];
    std::erase_if(arcs_, [&](const Arc& arc) {
      return arc.variable == variable && !placed[arc.from] && component_[arc.from] == component &&
             component_[arc.to] == component;
    });
  }

  Model& model_;
  SetModel& set_;
  std::vector<Arc> arcs_;
  std::vector<std::size_t> component_;
};

void SetOrder::find_components(const std::vector<Arc>& arcs, const std::vector<bool>& placed) {
  const std::size_t n = set_.tasks.size(), none = std::numeric_limits<std::size_t>::max();
  std::vector<std::vector<std::size_t>> next(n);
  for (const Arc& arc : arcs)
    if (!placed[arc.from] && !placed[arc.to]) next[arc.from].push_back(arc.to);
  std::vector<std::size_t> index(n, none), low(n, 0), stack;
  std::vector<bool> open(n, false);
  std::vector<std::pair<std::size_t, std::size_t>> calls;  // task, its next successor
  std::size_t count = 0;
  const auto enter = [&](std::size_t at) {
    index[at] = low[at] = count++;
    stack.push_back(at);
    open[at] = true;
    calls.push_back({at, 0});
  };
  for (std::size_t root = 0; root < n; ++root) {
    if (placed[root] || index[root] != none) continue;
    enter(root);
    while (!calls.empty()) {
      const std::size_t at = calls.back().first;
      if (calls.back().second < next[at].size()) {
        const std::size_t to = next[at][calls.back().second++];
        if (index[to] == none)
          enter(to);
        else if (open[to])
          low[at] = std::min(low[at], index[to]);
        continue;
      }
      calls.pop_back();
      if (!calls.empty()) low[calls.back().first] = std::min(low[calls.back().first], low[at]);
      if (low[at] != index[at]) continue;
      for (std::size_t member = none; member != at;) {
        member = stack.back();
        stack.pop_back();
        open[member] = false;
        component_[member] = at;
      }
    }
  }
}

}  // namespace

void order_sets(Model& model) {
  for (SetModel& set : model.sets) {
    SetOrder order(model, set);
    order.report_loops();
    order.order();
  }
}

}  // namespace chimera
