// SPDX-License-Identifier: Apache-2.0
// For tests: where two application specs differ, field by field.
#pragma once

#include <algorithm>
#include <string>

#include "chimera/runtime/application_spec.h"

namespace chimera::testing {

/// Says the first difference found; "" when there is none.
class SpecDifference {
 public:
  template <class T>
  void compare(const T& a, const T& b, const char* field) {
    if (!(a == b)) note(field);
  }
  template <class T>
  void values(std::span<const T> a, std::span<const T> b, const char* field) {
    if (!std::equal(a.begin(), a.end(), b.begin(), b.end())) note(field);
  }
  template <class T, class Each>
  void list(std::span<const T> a, std::span<const T> b, const char* field, Each each) {
    if (a.size() != b.size()) return note(field);
    const std::string outer = place_;
    for (std::size_t i = 0; i < a.size(); ++i) {
      place_ = outer + field + "[" + std::to_string(i) + "].";
      each(a[i], b[i]);
    }
    place_ = outer;
  }
  const std::string& said() const { return said_; }

 private:
  void note(const char* field) {
    if (said_.empty()) said_ = place_ + field;
  }
  std::string place_, said_;
};

template <class Item>
void compare_values(SpecDifference& d, const Item& a, const Item& b) {
  d.compare(a.type, b.type, "type");
  d.compare(a.element_bytes, b.element_bytes, "element_bytes");
  for (std::size_t i = 0; i < CHIMERA_MAX_EXTENTS; ++i) {
    d.compare(a.extent[i].max, b.extent[i].max, "extent.max");
    d.compare(a.extent[i].constant, b.extent[i].constant, "extent.constant");
    d.compare(a.listed[i], b.listed[i], "listed");
  }
  d.values(a.value, b.value, "value");
}

inline void compare_ports(SpecDifference& d, const PortSpec& a, const PortSpec& b) {
  d.compare(a.declared, b.declared, "declared");
  d.compare(a.kind, b.kind, "kind");
  d.compare(a.instance, b.instance, "instance");
  d.compare(a.variable, b.variable, "variable");
  d.compare(a.constant, b.constant, "constant");
  d.compare(a.unit, b.unit, "unit");
  d.compare(a.safety, b.safety, "safety");
  d.compare(a.min, b.min, "min");
  d.compare(a.max, b.max, "max");
  d.compare(a.has_range, b.has_range, "has_range");
  d.values(a.max_step, b.max_step, "max_step");
  d.compare(a.shared, b.shared, "shared");
  d.compare(a.intermittent, b.intermittent, "intermittent");
  compare_values(d, a, b);
}

inline void compare_tasks(SpecDifference& d, const TaskSpec& a, const TaskSpec& b) {
  d.compare(a.name, b.name, "name");
  d.compare(a.component, b.component, "component");
  d.compare(a.period, b.period, "period");
  d.compare(a.offset, b.offset, "offset");
  d.compare(a.deadline, b.deadline, "deadline");
  d.compare(a.budget, b.budget, "budget");
  d.compare(a.min_time, b.min_time, "min_time");
  d.compare(a.criticality, b.criticality, "criticality");
  d.compare(a.user_priority, b.user_priority, "user_priority");
  d.compare(a.on_miss, b.on_miss, "on_miss");
  d.compare(a.on_overrun, b.on_overrun, "on_overrun");
  d.compare(a.on_fault, b.on_fault, "on_fault");
  d.compare(a.on_miss_set, b.on_miss_set, "on_miss_set");
  d.compare(a.on_overrun_set, b.on_overrun_set, "on_overrun_set");
  d.compare(a.on_fault_set, b.on_fault_set, "on_fault_set");
  d.compare(a.max_consecutive, b.max_consecutive, "max_consecutive");
  d.compare(a.tolerated_misses, b.tolerated_misses, "tolerated_misses");
  d.compare(a.tolerated_of, b.tolerated_of, "tolerated_of");
  d.compare(a.place, b.place, "place");
  d.compare(a.stack_bytes, b.stack_bytes, "stack_bytes");
  d.compare(a.aperiodic, b.aperiodic, "aperiodic");
  d.compare(a.is_hardware, b.is_hardware, "is_hardware");
  d.compare(a.has_events, b.has_events, "has_events");
  d.compare(a.rtpu, b.rtpu, "rtpu");
  const ServerSpec one = a.server.value_or(ServerSpec{}), other = b.server.value_or(ServerSpec{});
  d.compare(a.server.has_value(), b.server.has_value(), "server");
  d.compare(one.kind, other.kind, "server.kind");
  d.compare(one.capacity, other.capacity, "server.capacity");
  d.compare(one.period, other.period, "server.period");
  d.list(a.ports, b.ports, "ports", [&](const PortSpec& p, const PortSpec& q) { compare_ports(d, p, q); });
}

inline void compare_variables(SpecDifference& d, const Variable& a, const Variable& b) {
  d.compare(a.name, b.name, "name");
  d.compare(a.operator_index, b.operator_index, "operator_index");
  d.values(a.producers, b.producers, "producers");
  d.values(a.consumers, b.consumers, "consumers");
}

inline void compare_constants(SpecDifference& d, const ConstantSpec& a, const ConstantSpec& b) {
  d.compare(a.name, b.name, "name");
  d.compare(a.type, b.type, "type");
  d.compare(a.element_bytes, b.element_bytes, "element_bytes");
  d.values(a.value, b.value, "value");
  for (std::size_t i = 0; i < CHIMERA_MAX_EXTENTS; ++i) d.compare(a.listed[i], b.listed[i], "listed");
  d.values(a.producers, b.producers, "producers");
}

/// "tasks[1].ports[0].value", or "".
inline std::string first_difference(const ApplicationSpec& a, const ApplicationSpec& b) {
  SpecDifference d;
  d.compare(a.name, b.name, "name");
  d.list(a.rtpus, b.rtpus, "rtpus", [&](const RtpuSpec& p, const RtpuSpec& q) {
    d.compare(p.link.address, q.link.address, "link.address");
    d.compare(p.link.is_udp, q.link.is_udp, "link.is_udp");
    d.compare(p.link.baud, q.link.baud, "link.baud");
    d.compare(p.link.period, q.link.period, "link.period");
    d.compare(p.link.stale_after, q.link.stale_after, "link.stale_after");
    d.compare(p.name, q.name, "name");
    d.compare(p.cpu, q.cpu, "cpu");
    d.compare(p.policy, q.policy, "policy");
    d.compare(p.preemptive, q.preemptive, "preemptive");
  });
  d.list(a.tasks, b.tasks, "tasks", [&](const TaskSpec& p, const TaskSpec& q) { compare_tasks(d, p, q); });
  const auto given = [&](const GivenSpec& p, const GivenSpec& q) {
    d.compare(p.name, q.name, "name");
    d.compare(p.variable, q.variable, "variable");
    compare_values(d, p, q);
  };
  d.list(a.variables, b.variables, "variables",
         [&](const Variable& p, const Variable& q) { compare_variables(d, p, q); });
  d.list(a.constants, b.constants, "constants",
         [&](const ConstantSpec& p, const ConstantSpec& q) { compare_constants(d, p, q); });
  d.list(a.operators, b.operators, "operators", given);
  d.values(a.init_order, b.init_order, "init_order");
  d.values(a.start, b.start, "start");
  d.values(a.on_order, b.on_order, "on_order");
  d.values(a.end_order, b.end_order, "end_order");
  d.list(a.sets, b.sets, "sets", [&](const NamedSet& p, const NamedSet& q) {
    d.compare(p.name, q.name, "name");
    d.values(p.order, q.order, "order");
    d.compare(p.safe_when, q.safe_when, "safe_when");
  });
  d.list(a.standbys, b.standbys, "standbys", [&](const StandbySpec& p, const StandbySpec& q) {
    d.compare(p.primary, q.primary, "primary");
    d.compare(p.standby, q.standby, "standby");
    d.compare(p.stale_after, q.stale_after, "stale_after");
    d.compare(p.hot, q.hot, "hot");
  });
  d.list(a.restarts, b.restarts, "restarts", [&](const RestartSpec& p, const RestartSpec& q) {
    d.compare(p.task, q.task, "task");
    d.compare(p.most, q.most, "most");
    d.compare(p.within, q.within, "within");
    d.compare(p.then, q.then, "then");
  });
  d.list(a.stale, b.stale, "stale", [&](const StaleSpec& p, const StaleSpec& q) {
    d.compare(p.task, q.task, "task");
    d.compare(p.after, q.after, "after");
  });
  return d.said();
}

}  // namespace chimera::testing
