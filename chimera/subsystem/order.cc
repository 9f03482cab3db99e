// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/order.h"

#include <algorithm>

namespace chimera::subsystem {
namespace {

std::vector<std::vector<TaskId>> makers(const ApplicationSpec& spec, std::uint32_t in_kind, std::uint32_t out_kind) {
  const auto has = [&](std::size_t task, std::uint32_t kind, std::string_view variable) {
    return std::any_of(spec.tasks[task].ports.begin(), spec.tasks[task].ports.end(),
                       [&](const PortSpec& port) { return port.kind == kind && port.variable == variable; });
  };
  std::vector<std::vector<TaskId>> found(spec.tasks.size());
  for (std::size_t t = 0; t < spec.tasks.size(); ++t)
    for (const PortSpec& port : spec.tasks[t].ports) {
      if (port.kind != in_kind || port.variable.empty()) continue;
      for (std::size_t m = 0; m < spec.tasks.size(); ++m)
        if (m != t && has(m, out_kind, port.variable)) found[t].push_back(TaskId(m));
    }
  return found;
}

/// Places one task after the other.
class Placement {
 public:
  explicit Placement(const ApplicationSpec& spec)
      : spec_(spec), makers_(makers(spec, CHIMERA_IN_VAR, CHIMERA_OUT_VAR)), placed_(spec.tasks.size(), false),
        starts_(spec.tasks.size(), false) {
    for (TaskId id : spec.start) starts_[id.index] = true;
    for (TaskId id : spec.start) rest_.push_back(id);
    for (const bool hardware : {true, false})
      for (std::size_t t = 0; t < spec.tasks.size(); ++t)
        if (!starts_[t] && spec.tasks[t].is_hardware == hardware) rest_.push_back(TaskId(t));
  }

  std::vector<TaskId> all() {
    std::vector<TaskId> order;
    while (!rest_.empty()) {
      auto next = std::find_if(rest_.begin(), rest_.end(), [this](TaskId id) { return is_ready(id); });
      if (next == rest_.end()) next = rest_.begin();
      placed_[next->index] = true;
      order.push_back(*next);
      rest_.erase(next);
    }
    return order;
  }

 private:
  // Within the start set its own order holds, so only the first of it that is left may come.
  bool is_ready(TaskId id) const {
    if (starts_[id.index] && id != rest_.front()) return false;
    if (spec_.tasks[id.index].is_hardware) return true;
    return std::all_of(makers_[id.index].begin(), makers_[id.index].end(), [&](TaskId maker) {
      return placed_[maker.index] || (starts_[id.index] && starts_[maker.index]);
    });
  }

  const ApplicationSpec& spec_;
  std::vector<std::vector<TaskId>> makers_;
  std::vector<bool> placed_;
  std::vector<bool> starts_;
  std::vector<TaskId> rest_;
};

}  // namespace

std::vector<TaskId> data_flow_order(const ApplicationSpec& spec) { return Placement(spec).all(); }

std::vector<std::vector<TaskId>> makers_of_constants(const ApplicationSpec& spec) {
  return makers(spec, CHIMERA_IN_CONST, CHIMERA_OUT_CONST);
}

}  // namespace chimera::subsystem
