// SPDX-License-Identifier: Apache-2.0
// Resolves names, judges acts other than signals, and carries them out on the operator variables and the flag.
#include "chimera/manager/act/operator_acts.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/manager/act/operator_values.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/answer/value_json.h"
#include "chimera/text/json.h"
#include "chimera/verify/setting.h"

namespace chimera::manager {
namespace {

using control::RpcResponse;

std::vector<std::string> variable_names(const ManagerState& state) {
  return state.readings ? names_of(state.readings->variables().all(), &Variable::name) : std::vector<std::string>();
}

/// Elements in a row of an operator variable; 0 if it has one dimension.
std::size_t columns(const ManagerState& state, VariableId variable) {
  const std::uint32_t index = state.readings->variables().all()[variable.index].operator_index;
  const std::string& shape = state.readings->configured(variable).shape;
  const bool has_rows = shape.find("][") != std::string::npos;
  return has_rows ? state.spec().operators[index].extent[1].max : 0;
}

RpcResponse no_operators(const ManagerState& state, VariableId variable, const std::string& name) {
  const TaskId task = state.readings->producer(variable);
  const std::string who = task.is_valid() ? "task " + state.name(task) : "a task";
  return RpcResponse::refused("not-operator", name + " is produced by " + who + ", not by the operator", name);
}

}  // namespace

std::variant<std::vector<VariableId>, RpcResponse> variables_named(const ManagerState& state,
                                                                   const std::vector<std::string>& names) {
  std::vector<VariableId> found;
  if (names.empty() && state.readings)
    for (std::size_t v = 0; v < state.readings->size(); ++v) found.emplace_back(v);
  std::vector<bool> is_named(state.readings ? state.readings->size() : 0);
  for (const std::string& name : names) {
    const auto variable = state.readings ? state.readings->find(name) : std::nullopt;
    const std::string constant = variable || !state.configuration ? "" : about_constant(*state.configuration, name);
    if (!constant.empty()) return RpcResponse::unknown(constant, name, "");
    if (!variable) return RpcResponse::no_such("state variable", name, variable_names(state));
    if (!is_named[variable->index]) found.push_back(*variable);
    is_named[variable->index] = true;
  }
  return found;
}

std::variant<std::vector<TaskId>, RpcResponse> tasks_named(const ManagerState& state,
                                                           const std::vector<std::string>& names) {
  if (names.empty())
    return RpcResponse::error(control::kBadParameters, "'tasks' must name at least one", {{"where", "tasks"}});
  std::vector<TaskId> found;
  const auto known = names_of(state.spec().tasks, &TaskSpec::name);
  for (const std::string& name : names) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) return RpcResponse::no_such("task", name, known);
    found.emplace_back(static_cast<std::size_t>(at - known.begin()));
  }
  return found;
}

RpcResponse judge_ring(const ManagerState& state, TaskId task) {
  const std::string name = state.name(task);
  if (!state.spec().tasks[task.index].has_doorbell())
    return RpcResponse::refused("no-server", name + " has no doorbell: neither a server nor events release it", name,
                                "give it 'server:' in the description");
  const State now = state.state(task);
  if (now == State::kOn) return {};
  return RpcResponse::refused("state", name + " is " + state_name(now) + ": no job would answer the event", name,
                              "turn it ON first");
}

RpcResponse set_values(ManagerState& state, const Json& values) {
  std::vector<VariableId> variables;
  std::map<std::string, ValueForm> forms;
  for (const auto& [name, value] : values.items()) {
    const auto found = variables_named(state, {name});
    if (const auto* refused = std::get_if<RpcResponse>(&found)) return *refused;
    const VariableId variable = std::get<0>(found)[0];
    if (!state.readings->is_operators(variable)) return no_operators(state, variable, name);
    variables.push_back(variable);
    forms[name] = state.readings->form(variable);
  }
  if (variables.empty())
    return RpcResponse::error(control::kBadParameters, "'values' must name at least one variable",
                              {{"where", "values"}});
  const auto bytes = operator_bytes(*state.configuration, state.bundle.library, values, forms);
  if (!bytes)
    return RpcResponse::error(control::kBadParameters, std::string(bytes.error().message.view()),
                              {{"where", bytes.error().where.view()}});
  const Nanoseconds at = now();
  for (const auto& [index, value] : *bytes) state.own.publish_operator(index, value, at);
  Json answer = {{"values", readings_json(state, variables, at)}};
  for (const auto& [name, reading] : answer["values"].items())
    state.tell("set", TaskId{}, RtpuId{}, name + " = " + reading["text"].as_string(), at);
  return RpcResponse::good(answer);
}

RpcResponse set_flag(ManagerState& state, bool up) {
  auto& flag = state.own.block().head().flag;
  const std::uint32_t before = flag.load(std::memory_order_relaxed);
  flag.store(up ? before | kOperatorFlag : before & ~kOperatorFlag, std::memory_order_release);
  if (flag.load(std::memory_order_relaxed) != before) {
    const char* words = up ? "the operator raised the flag" : "the operator lowered the flag";
    state.tell("flag", TaskId{}, RtpuId{}, words, now());
    state.announce();
  }
  return RpcResponse::good(flag_json(state));
}

RpcResponse saved_values(const ManagerState& state) {
  Json saved = Json::object();
  if (!state.readings) return RpcResponse::good({{"operator", std::move(saved)}});
  for (const NamedNode& given : state.configuration->draft().operators) {
    const auto variable = state.readings->find(given.name.text);
    if (!variable) continue;  // no task reads it
    const VariableReading reading = state.readings->read(*variable);
    const std::string text = description_text(reading.form, reading.value, columns(state, *variable));
    saved[given.name.text] = in_words_of(given.value, text, state.bundle.library.units());
  }
  return RpcResponse::good({{"operator", std::move(saved)}});
}

}  // namespace chimera::manager
