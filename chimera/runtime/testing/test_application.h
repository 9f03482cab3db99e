// SPDX-License-Identifier: Apache-2.0
// For tests: an application put together by hand, from components written in the test itself.
#pragma once

#include <cstring>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "chimera/runtime/testing/named_links.h"
#include "chimera/task/component.h"

namespace chimera::testing {

/// The declaration of component class T under `name`.
template <class T>
const chimera_component* component(const char* name) {
  component_api::declared<T>.component.name = name;
  component_api::declared<T>.component.doc = "A component of a test.";
  component_api::declared<T>.component.source = "";
  return component_api::declare<T>();
}

template <class T>
std::vector<std::byte> bytes_of(const T& value) {
  std::vector<std::byte> bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// Owns what an ApplicationSpec points at. Ports bind to variables of their own name unless aliased.
class TestApplication {
 public:
  /// Adds a task with every port bound by name; returns its specification for changes before make().
  TaskSpec& add(const char* name, const chimera_component* component, Nanoseconds period = milliseconds(1)) {
    components.push_back(component);
    auto& ports = ports_.emplace_back();
    auto& names = names_.emplace_back();
    for (std::uint32_t p = 0; p < component->n_ports; ++p) {
      const chimera_port_decl& decl = component->ports[p];
      PortSpec port;
      port.declared = p;
      port.kind = decl.kind;
      names.emplace_back(decl.name);
      port.name = decl.name;
      port.element_bytes = decl.element_size;
      port.type = decl.type;
      port.safety = (decl.flags & CHIMERA_PORT_SAFETY) != 0;
      port.intermittent = (decl.flags & CHIMERA_PORT_INTERMITTENT) != 0;
      port.has_range = (decl.flags & CHIMERA_PORT_HAS_RANGE) != 0;
      port.min = decl.min;
      port.max = decl.max;
      if (decl.flags & CHIMERA_PORT_HAS_INITIAL)
        port.value = {static_cast<const std::byte*>(decl.initial), decl.initial_count * decl.element_size};
      ports.push_back(port);
    }
    TaskSpec& task = tasks.emplace_back();
    task.name = name;
    task.component = component->name;
    task.period = task.deadline = period;
    task.aperiodic = component->methods[CHIMERA_SYNC] != nullptr;
    for (const PortSpec& port : ports) task.is_hardware = task.is_hardware || port.kind == CHIMERA_RESOURCE;
    return task;
  }
  PortSpec& port(std::size_t task, std::size_t index) { return ports_[task][index]; }
  /// The second instance of a repeated port, linked to `name`. Call it before extend().
  void add_instance(std::size_t task, std::size_t index, std::string_view name) {
    ports_[task].push_back(PortSpec(ports_[task][index]));
    ports_[task].back().instance = 1;
    names_[task].push_back(name);
  }
  /// As an alias does: the port is linked to `name`, and to nothing when that is "". Takes effect with make().
  void link(std::size_t task, std::size_t index, std::string_view name) { names_[task][index] = name; }
  /// Up to `max` elements, as many as the constant of that name says. Takes effect with make().
  void extend(std::size_t task, std::size_t index, std::uint32_t max, std::string_view constant) {
    ports_[task][index].extent[0].max = max;
    extents_.push_back({&ports_[task][index].extent[0], constant});
  }
  void give(std::vector<GivenSpec>& to, const char* name, std::uint32_t type, std::vector<std::byte> value) {
    values_.push_back(std::move(value));
    to.push_back({name, {}, type, static_cast<std::uint32_t>(values_.back().size()), {}, values_.back()});
  }
  const ApplicationSpec& make(std::vector<TaskId> to_start = {}, bool start_all = true) {
    init_order.clear();
    start = std::move(to_start);
    links_ = NamedLinks();
    for (GivenSpec& given : operators) given.variable = links_.variable(given.name);
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      for (std::size_t p = 0; p < ports_[t].size(); ++p) links_.link(ports_[t][p], names_[t][p]);
      tasks[t].ports = ports_[t];
      init_order.push_back(TaskId(t));
      if (start_all) start.push_back(TaskId(t));
    }
    for (const auto& [extent, constant] : extents_) extent->constant = links_.constant(constant);
    spec = {};
    spec.name = "test";
    spec.rtpus = rtpus;
    spec.tasks = tasks;
    spec.operators = operators;
    spec.init_order = init_order;
    spec.start = start;
    links_.finish(spec);
    return spec;
  }

  std::vector<RtpuSpec> rtpus{{"main", 0, Policy::kEdf}};
  std::vector<TaskSpec> tasks;
  std::vector<const chimera_component*> components;
  std::vector<GivenSpec> operators;
  std::vector<TaskId> init_order, start;
  ApplicationSpec spec;

 private:
  std::deque<std::vector<PortSpec>> ports_;
  std::deque<std::vector<std::string_view>> names_;  // of what each port is linked to
  std::vector<std::pair<ExtentSpec*, std::string_view>> extents_;  // and the constants that fix them
  NamedLinks links_;
  std::deque<std::vector<std::byte>> values_;
};

}  // namespace chimera::testing
