// SPDX-License-Identifier: Apache-2.0
// Computes the order in which jobs of equal urgency run: producers before their readers.
#include <algorithm>
#include <bitset>
#include <vector>

#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

/// One bit for each task: a description has at most kMaxTasks.
using Tasks = std::bitset<kMaxTasks>;

/// `to` reads in its cycle what `from` produces.
struct CycleLink {
  std::size_t from, to;
  int cut;  ///< a loop is cut at its highest: 2 an `initial` of the description, 1 backward in the text, 0 forward
  const std::string* variable;
};

/// Adds links one by one, those at which a loop is cut best last. A link that would close a loop is left out.
class CycleOrder {
 public:
  explicit CycleOrder(Model& model) : model_(model), before_(model.tasks.size()) {
    for (const VariableModel& variable : model.variables)
      for (const PortRef from : variable.producers)
        for (const PortRef to : variable.consumers)
          if (!variable.is_constant && from.task != to.task && !may_be_left_out(*model.port(to).declared))
            links_.push_back({from.task, to.task, model.port(from).own != nullptr ? 2 : from.task > to.task ? 1 : 0,
                              &variable.name});
    std::ranges::stable_sort(links_, [](const CycleLink& a, const CycleLink& b) {
      return a.cut != b.cut ? a.cut < b.cut : *a.variable > *b.variable;
    });
  }

  void add_links_within(const std::vector<TaskId>& set) {
    Tasks is_in;
    for (const TaskId task : set) is_in.set(task.index);
    for (const StandbySpec& each : model_.standbys)
      if (is_in[each.primary.index]) is_in.set(each.standby.index);
    for (const CycleLink& link : links_)
      if (is_in[link.from] && is_in[link.to]) add(link.from, link.to);
  }
  void add_all_links() {
    for (const CycleLink& link : links_) add(link.from, link.to);
  }

  /// The next place is that of the first task in the text without a producer that still waits.
  void give_places() {
    Tasks is_placed;
    for (std::uint32_t place = 0; place < before_.size(); ++place) {
      std::size_t next = 0;
      while (is_placed[next] || (before_[next] & ~is_placed).any()) ++next;
      is_placed.set(next);
      model_.tasks[next].place = place;
    }
  }

 private:
  void add(std::size_t from, std::size_t to) {
    if (before_[from][to]) return;
    Tasks ahead = before_[from];
    ahead.set(from);
    for (std::size_t task = 0; task < before_.size(); ++task)
      if (task == to || before_[task][to]) before_[task] |= ahead;
  }

  Model& model_;
  std::vector<CycleLink> links_;
  std::vector<Tasks> before_;  // [t]: the tasks that come before t
};

}  // namespace

void order_cycles(Model& model) {
  CycleOrder order(model);
  order.add_links_within(model.sets[model.start].tasks);
  for (const SetModel& set : model.sets) order.add_links_within(set.tasks);
  order.add_all_links();
  order.give_places();
}

}  // namespace chimera
