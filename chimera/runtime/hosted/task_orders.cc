// SPDX-License-Identifier: Apache-2.0
// Orders of tasks from the links: a list of tasks that wait, of which the first whose producers are all placed is next.
#include "chimera/runtime/hosted/task_orders.h"

#include <algorithm>

namespace chimera {
namespace {

/// Places one task after the other.
class Placement {
 public:
  explicit Placement(const ApplicationSpec& spec)
      : spec_(spec), producers_(spec.tasks.size()), placed_(spec.tasks.size(), false),
        starts_(spec.tasks.size(), false) {
    for (const Variable& variable : spec.variables)
      for (const PortOf& to : variable.consumers)
        for (const PortOf& from : variable.producers)
          if (from.task != to.task) producers_[to.task.index].push_back(from.task);
    for (const TaskId id : spec.start) starts_[id.index] = true;
    waiting_.assign(spec.start.begin(), spec.start.end());
    for (const bool hardware : {true, false})
      for (std::size_t t = 0; t < spec.tasks.size(); ++t)
        if (!starts_[t] && spec.tasks[t].is_hardware == hardware) waiting_.push_back(TaskId(t));
  }

  std::vector<TaskId> all() {
    std::vector<TaskId> order;
    while (!waiting_.empty()) {
      auto next = std::find_if(waiting_.begin(), waiting_.end(), [this](TaskId id) { return is_ready(id); });
      if (next == waiting_.end()) next = waiting_.begin();
      placed_[next->index] = true;
      order.push_back(*next);
      waiting_.erase(next);
    }
    return order;
  }

 private:
  // Within the start set its own order holds, so only the first of it that is left may come.
  bool is_ready(TaskId id) const {
    if (starts_[id.index] && id != waiting_.front()) return false;
    if (spec_.tasks[id.index].is_hardware) return true;
    const auto& producers = producers_[id.index];
    return std::all_of(producers.begin(), producers.end(), [&](TaskId producer) {
      return placed_[producer.index] || (starts_[id.index] && starts_[producer.index]);
    });
  }

  const ApplicationSpec& spec_;
  std::vector<std::vector<TaskId>> producers_;  // by task
  std::vector<bool> placed_;
  std::vector<bool> starts_;
  std::vector<TaskId> waiting_;  // the start set first
};

}  // namespace

std::vector<TaskId> make_on_order(const ApplicationSpec& spec) { return Placement(spec).all(); }

std::vector<TaskId> make_end_order(const ApplicationSpec& spec) {
  std::vector<TaskId> order(spec.on_order.rbegin(), spec.on_order.rend());
  std::stable_partition(order.begin(), order.end(), [&](TaskId id) { return !spec.tasks[id.index].is_hardware; });
  return order;
}

}  // namespace chimera
