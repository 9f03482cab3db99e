// SPDX-License-Identifier: Apache-2.0
// Rules on the component of a task. The component must be known, built and of a supported kind. Each key of the task
// names a port of the component, of the kind that the key accepts.
#include <algorithm>
#include <optional>
#include <string_view>

#include "chimera/base/assert.h"
#include "chimera/description/draft_values.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

void refuse_unbuilt(Model& model, const DraftTask& task) {
  const std::string& name = task.component.text;
  model.error("component-unknown", task.component.at,
              "task '" + task.name.text + "': the component '" + name + "' is not built: only its source is here", name,
              "a component that is built", "", "'./dev install' in the checkout builds and installs the whole library");
}

void refuse_streams(Model& model, const TaskModel& task) {
  for (const PortDescriptor& port : task.component->ports)
    if (port.kind == CHIMERA_IN_STREAM || port.kind == CHIMERA_OUT_STREAM)
      model.error("port-stream", Spot(task.draft->component.at, port.name),
                  "task '" + task.name() + "': port '" + port.name + "' of component '" + task.component->name +
                      "' is a stream; streams are not built yet",
                  port.name, "a component without streams");
}

/// The reason why the descriptor of the component is not in the library; nullptr: none.
const Error* fault_of(const Model& model, const std::string& component) {
  for (const Error& fault : model.library.faults())
    if (fault.where.view().ends_with("/" + component + ".component.json")) return &fault;
  return nullptr;
}

void refuse_unknown(Model& model, const DraftTask& task) {
  const std::string& name = task.component.text;
  const std::string component = "task '" + task.name.text + "': the component '" + name + "' ";
  if (const Error* fault = fault_of(model, name)) {
    const std::string why = std::string(fault->where.view()) + ": " + std::string(fault->message.view());
    model.error("component-unknown", task.component.at, component + "cannot be used: " + why, name,
                "a component whose descriptor can be read", {}, "rebuild the component " + name);
    return;
  }
  const std::string near = model.library.nearest_name(name);
  std::string remedy = "'chimera list' shows the library; CHIMERA_PATH adds folders to it";
  for (const std::string& folder : model.library.missing_folders())
    remedy += "; CHIMERA_PATH names " + folder;
  model.error("component-unknown", task.component.at, component + "is not in the library", name,
              "a component of the library", near, near.empty() ? remedy : "");
}

std::vector<std::string> port_names(const Descriptor& component, bool (*wanted)(std::uint32_t kind)) {
  std::vector<std::string> names;
  for (const PortDescriptor& port : component.ports)
    if (wanted(port.kind)) names.push_back(port.name);
  return names;
}

bool is_linkable(std::uint32_t kind) {
  return kind == CHIMERA_IN_VAR || kind == CHIMERA_OUT_VAR || kind == CHIMERA_IN_CONST || kind == CHIMERA_OUT_CONST;
}
bool is_in_const(std::uint32_t kind) { return kind == CHIMERA_IN_CONST; }
bool is_out_var(std::uint32_t kind) { return kind == CHIMERA_OUT_VAR; }
bool is_resource(std::uint32_t kind) { return kind == CHIMERA_RESOURCE; }

/// The ports that a key of a task may name.
struct Wanted {
  const char* key;
  bool (*fits)(std::uint32_t kind);
  const char* kinds;  ///< "in-const"
};

std::string with_article(const std::string& noun) { return (noun[0] == 'i' || noun[0] == 'o' ? "an " : "a ") + noun; }

/// Checks that `name` under a key is a port of a fitting kind.
void check_key(Model& model, TaskModel& task, const Word& name, const Wanted& wanted) {
  const PortDescriptor* port = task.component->port(name.text);
  if (port != nullptr && wanted.fits(port->kind)) return;
  task.lacks_link = true;
  const std::vector<std::string> names = port_names(*task.component, wanted.fits);
  const std::string key = "'" + std::string(wanted.key) + "' of task '" + task.name() + "': ";
  const std::string of = "component '" + task.component->name + "'";
  const std::string there_are = std::string("its ") + wanted.kinds + " ports: " + listed(names);
  if (port == nullptr) {
    const std::string near = nearest(name.text, names);
    model.error("port-unknown", name.at, key + of + " has no port '" + name.text + "'", name.text, listed(names), near,
                near.empty() ? there_are : "");
    return;
  }
  const std::string kind(kind_name(port->kind));
  model.error("port-kind", name.at,
              key + "port '" + name.text + "' of " + of + " is " + with_article(kind) + "; expected " +
                  with_article(wanted.kinds),
              kind, wanted.kinds, {}, there_are);
}

void check_keys(Model& model, TaskModel& task) {
  constexpr Wanted kAlias{"alias", is_linkable, "variable or constant"},
      kConstants{"constants", is_in_const, "in-const"}, kResources{"resources", is_resource, "resource"},
      kInitial{"initial", is_out_var, "out-var"}, kMaxStep{"max_step", is_out_var, "out-var"};
  const DraftTask& draft = *task.draft;
  for (const DraftAlias& alias : draft.alias) check_key(model, task, alias.port, kAlias);
  for (const NamedNode& value : draft.constants) check_key(model, task, value.name, kConstants);
  for (const NamedNode& value : draft.resources) check_key(model, task, value.name, kResources);
  for (const NamedNode& value : draft.initial) check_key(model, task, value.name, kInitial);
  for (const NamedNode& value : draft.max_step) check_key(model, task, value.name, kMaxStep);
}

const DraftAlias* alias_of(const DraftTask& draft, std::string_view port) {
  for (const DraftAlias& alias : draft.alias)
    if (alias.port.text == port) return &alias;
  return nullptr;
}

const NamedNode* named(const std::vector<NamedNode>& values, std::string_view name) {
  for (const NamedNode& value : values)
    if (value.name.text == name) return &value;
  return nullptr;
}

/// The value of `port` under the own keys of the task, or nullptr.
const Node* own_value(const DraftTask& draft, const PortDescriptor& port) {
  const std::vector<NamedNode>* values = port.kind == CHIMERA_IN_CONST   ? &draft.constants
                                         : port.kind == CHIMERA_OUT_VAR  ? &draft.initial
                                         : port.kind == CHIMERA_RESOURCE ? &draft.resources
                                                                         : nullptr;
  const NamedNode* value = values != nullptr ? named(*values, port.name) : nullptr;
  return value != nullptr ? &value->value : nullptr;
}

/// The number of instances of a repeated port, and its place: the alias, otherwise the list under `constants` or
/// `resources`. A constant with a default may have none.
struct Instances {
  std::size_t count = 0;
  Place at;
};

Instances count_instances(const TaskModel& task, const PortDescriptor& port, const DraftAlias* alias) {
  if (alias != nullptr) return {alias->variables.size(), alias->port.at};
  const Node* own = port.kind == CHIMERA_OUT_VAR ? nullptr : own_value(*task.draft, port);
  if (own != nullptr) return {own->is_list() ? own->items.size() : 1, own->at};
  return {port.kind == CHIMERA_RESOURCE ? 1u : 0u, task.draft->name.at};  // require_resources requires the text
}

/// The number of instances of the port, or nullopt and a fault if it is illegal.
std::optional<std::size_t> instances(Model& model, const TaskModel& task, const PortDescriptor& port,
                                     const DraftAlias* alias) {
  const Instances found = count_instances(task, port, alias);
  // An empty list means that no instance is wanted; a missing port may be an oversight.
  const bool may_have_none =
      may_be_left_out(port) || (port.kind == CHIMERA_IN_CONST && !port.initial.empty());
  const bool is_said_none = alias != nullptr && alias->variables.empty();
  const std::size_t least = may_have_none || is_said_none ? 0 : 1;
  if (found.count >= least && found.count <= port.max_instances) return found.count;
  const std::string range = std::to_string(least) + " to " + std::to_string(port.max_instances);
  model.error("repeated-port", Spot(found.at, port.name),
              "repeated port '" + port.name + "' of task '" + task.name() + "' has " + std::to_string(found.count) +
                  " instances; expected " + range,
              std::to_string(found.count), range, {}, "write alias: {" + port.name + ": [variable, variable]}");
  return std::nullopt;
}

void add_port(TaskModel& task, std::size_t task_index, std::uint32_t index, std::uint32_t instance,
              const DraftAlias* alias) {
  const PortDescriptor& declared = task.component->ports[index];
  LinkedPort port;
  port.declared = &declared;
  port.index = index;
  port.instance = instance;
  port.task = task_index;
  port.name = declared.repeated ? declared.name + '[' + std::to_string(instance) + ']' : declared.name;
  port.at = alias != nullptr ? alias->port.at : task.draft->name.at;
  port.own = own_value(*task.draft, declared);
  const bool has_list = port.own != nullptr && declared.repeated && port.own->is_list();
  port.is_own_item = has_list && !port.is(CHIMERA_OUT_VAR);
  if (port.is_own_item) port.own = &port.own->items[instance];
  if (is_linkable(declared.kind)) port.variable = declared.name;
  if (alias != nullptr) {
    port.variable = alias->variables[instance].text;
    port.at = alias->variables[instance].at;
  }
  task.ports.push_back(std::move(port));
}

void link_port(Model& model, std::size_t task_index, std::uint32_t index) {
  TaskModel& task = model.tasks[task_index];
  const PortDescriptor& port = task.component->ports[index];
  const DraftAlias* alias = is_linkable(port.kind) ? alias_of(*task.draft, port.name) : nullptr;
  if (alias != nullptr && alias->is_list != port.repeated) {
    const std::string expected = port.repeated ? "a list of variables" : "one variable";
    model.error("alias-list", alias->port.at,
                "'alias' of task '" + task.name() + "': port '" + port.name + "' is " +
                    (port.repeated ? "repeated" : "not repeated") + "; expected " + expected,
                port.name, expected, {},
                port.repeated ? "write " + port.name + ": [variable, variable]" : "write " + port.name + ": variable");
    alias = nullptr;
    task.lacks_link = true;
    if (port.repeated) return;
  }
  const std::optional<std::size_t> count = port.repeated ? instances(model, task, port, alias) : 1;
  task.lacks_link = task.lacks_link || !count;
  for (std::uint32_t i = 0; i < count.value_or(0); ++i) add_port(task, task_index, index, i, alias);
}

/// True if a task of each configuration with `task` produces a variable of the port's name, type and unit.
bool is_offered(const Model& model, std::size_t task, const PortDescriptor& port) {
  const auto makes_it = [&](const LinkedPort& other) {
    const PortDescriptor& declared = *other.declared;
    return declared.kind == CHIMERA_OUT_VAR && other.variable == port.name && declared.type == port.type &&
           declared.type_name == port.type_name && declared.unit == port.unit;
  };
  const auto produces = [&](const TaskModel& other) { return std::ranges::any_of(other.ports, makes_it); };
  const std::size_t reader = model.primary_of(task).value_or(task);
  const auto offers = [&](const SetModel& set) {
    return !set.has(reader) ||
           std::ranges::any_of(set.tasks, [&](TaskId other) { return produces(model.tasks[other.index]); });
  };
  return std::ranges::any_of(model.tasks, produces) && std::ranges::all_of(model.sets, offers);
}

}  // namespace

void find_components(Model& model) {
  for (const DraftTask& draft : model.draft.tasks) {
    TaskModel task;
    task.draft = &draft;
    const LibraryEntry* entry = draft.component.empty() ? nullptr : model.library.find(draft.component.text);
    if (entry != nullptr) {
      task.component = &entry->descriptor;
      refuse_streams(model, task);
    } else if (model.library.is_unbuilt(draft.component.text)) {
      refuse_unbuilt(model, draft);
    } else if (!draft.component.empty()) {
      refuse_unknown(model, draft);
    }
    model.tasks.push_back(std::move(task));
  }
}

void link_ports(Model& model) {
  for (std::size_t i = 0; i < model.tasks.size(); ++i) {
    TaskModel& task = model.tasks[i];
    if (task.component == nullptr) continue;
    check_keys(model, task);
    for (std::uint32_t p = 0; p < task.component->ports.size(); ++p) link_port(model, i, p);
    CHIMERA_ASSERT(task.ports.size() <= CHIMERA_MAX_PORTS);  // describe() counts every instance
  }
}

void link_left_out(Model& model) {
  for (std::size_t t = 0; t < model.tasks.size(); ++t) {
    TaskModel& task = model.tasks[t];
    if (task.component == nullptr) continue;
    for (std::uint32_t p = 0; p < task.component->ports.size(); ++p) {
      const PortDescriptor& port = task.component->ports[p];
      const bool is_open = may_be_left_out(port) && alias_of(*task.draft, port.name) == nullptr;
      if (is_open && is_offered(model, t, port)) add_port(task, t, p, 0, nullptr);
    }
    std::ranges::stable_sort(task.ports, {}, &LinkedPort::index);
  }
}

void require_resources(Model& model) {
  for (const TaskModel& task : model.tasks)
    for (const LinkedPort& port : task.ports)
      if (port.is(CHIMERA_RESOURCE) && port.own == nullptr && !task.is_partial())
        model.error("resource-missing", port,
                    "task '" + task.name() + "': the resource '" + port.declared->name + "' is not given", {},
                    port.declared->name, {},
                    "write resources: {" + port.declared->name + ": ...}" +
                        (port.declared->doc.empty() ? "" : " (" + port.declared->doc + ")"));
}

}  // namespace chimera
