// SPDX-License-Identifier: Apache-2.0
// Writes the profile of a task as JSON and reads that JSON back.
#include "chimera/analysis/task_profile.h"

#include <algorithm>
#include <array>

#include "chimera/text/json.h"

namespace chimera {
namespace {

/// The counters, in the order of docs/formats/run.md.
struct Counter {
  const char* key;
  std::uint64_t Profile::*count;
};
constexpr std::array<Counter, 15> kCounters = {{{"missed", &Profile::missed},
                                                {"overrun", &Profile::overrun},
                                                {"min_refused", &Profile::min_refused},
                                                {"dropped", &Profile::dropped},
                                                {"held", &Profile::held},
                                                {"aborted", &Profile::aborted},
                                                {"partial", &Profile::partial},
                                                {"tolerated", &Profile::tolerated},
                                                {"stale", &Profile::stale},
                                                {"rejected", &Profile::rejected},
                                                {"preempted", &Profile::preempted},
                                                {"demoted", &Profile::demoted},
                                                {"events", &Profile::events},
                                                {"events_lost", &Profile::events_lost},
                                                {"exhausted", &Profile::exhausted}}};

Json json_of(const Spread& spread) {
  if (spread.count == 0) return {{"count", 0}};
  return {{"count", spread.count}, {"min", spread.min.count}, {"mean", spread.mean().count}, {"max", spread.max.count}};
}

Json json_of(const FaultRecord& faults, Nanoseconds origin) {
  return {{"method", method_name(faults.method)},
          {"at_ns", (faults.at - origin).count},
          {"code", faults.last.code},
          {"text", faults.last.text}};
}

Json json_of(const TaskProfile& task, Nanoseconds origin) {
  const Profile& p = task.profile;
  Json methods = Json::object();
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m)
    if (p.execution[m].count > 0) methods[method_name(static_cast<Method>(m))] = json_of(p.execution[m]);
  Json json = {{"task", task.task},
               {"component", task.component},
               {"rtpu", task.rtpu},
               {"state", state_name(task.state)},
               {"period_ns", task.period.count},
               {"server", server_json(task.server)},
               {"on_ns", task.on.count},
               {"cycles", p.cycles},
               {"execution_ns", std::move(methods)},
               {"response_ns", json_of(p.response)},
               {"start_delay_ns", json_of(p.start_delay)},
               {"transfer", {{"groups", task.transfer.groups}, {"bytes", task.transfer.bytes}}}};
  for (const Counter& counter : kCounters) json[counter.key] = p.*counter.count;
  if (p.restarts > 0) json["restarts"] = p.restarts;
  if (p.takeovers > 0) json["takeovers"] = p.takeovers;
  json["faults"] = task.faults.count;
  if (task.faults.count > 0) json["last_fault"] = json_of(task.faults, origin);
  if (task.faults.notes > 0) json["note"] = task.faults.note;
  return json;
}

Spread spread_of(const Json& json) {
  Spread spread;
  spread.count = json.at("count").as_uint64();
  if (spread.count == 0) return spread;
  spread.min = {json.at("min").as_int64()};
  spread.max = {json.at("max").as_int64()};
  spread.sum = {json.at("mean").as_int64() * static_cast<std::int64_t>(spread.count)};
  return spread;
}

State state_of(const std::string& name) {
  for (int s = 0; s < kStates; ++s)
    if (name == state_name(static_cast<State>(s))) return static_cast<State>(s);
  throw std::invalid_argument("unknown state " + name);
}

Method method_of(const std::string& name) {
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m)
    if (name == method_name(static_cast<Method>(m))) return static_cast<Method>(m);
  throw std::invalid_argument("unknown method " + name);
}

void keep(const std::string& text, char (&to)[CHIMERA_FAULT_TEXT]) {
  std::copy_n(text.begin(), std::min(text.size(), sizeof to - 1), to);
}

FaultRecord fault_of(const Json& json, std::uint64_t count, Nanoseconds origin) {
  FaultRecord faults;
  faults.count = count;
  faults.method = method_of(json.at("method").as_string());
  faults.at = origin + Nanoseconds{json.at("at_ns").as_int64()};
  faults.last.code = static_cast<std::int32_t>(json.at("code").as_int64());
  keep(json.at("text").as_string(), faults.last.text);
  return faults;
}

ServerSpec server_of(const Json& json) {
  const std::string kind = json.at("kind").as_string();
  for (const ServerKind known : {ServerKind::kDeferrable, ServerKind::kSporadic})
    if (kind == server_kind_name(known))
      return {known, {json.at("capacity_ns").as_int64()}, {json.at("period_ns").as_int64()}};
  throw std::invalid_argument("unknown server " + kind);
}

TaskProfile profile_of(const Json& json, Nanoseconds origin) {
  TaskProfile made;
  made.task = json.at("task").as_string();
  made.component = json.at("component").as_string();
  made.rtpu = json.at("rtpu").as_string();
  made.state = state_of(json.at("state").as_string());
  made.period = {json.at("period_ns").as_int64()};
  made.on = {json.at("on_ns").as_int64()};
  if (const Json& server = json.at("server"); !server.is_null()) made.server = server_of(server);
  made.profile.cycles = json.at("cycles").as_uint64();
  for (const auto& [method, spread] : json.at("execution_ns").items())
    made.profile.execution[static_cast<std::uint32_t>(method_of(method))] = spread_of(spread);
  made.profile.response = spread_of(json.at("response_ns"));
  made.profile.start_delay = spread_of(json.at("start_delay_ns"));
  made.transfer.groups = static_cast<std::uint32_t>(json.at("transfer").at("groups").as_uint64());
  made.transfer.bytes = static_cast<std::uint32_t>(json.at("transfer").at("bytes").as_uint64());
  for (const Counter& counter : kCounters) made.profile.*counter.count = json.at(counter.key).as_uint64();
  const auto faults = json.at("faults").as_uint64();
  if (faults > 0) made.faults = fault_of(json.at("last_fault"), faults, origin);
  if (const Json* note = json.find("note"); note != nullptr) {
    made.faults.notes = 1;
    keep(note->as_string(), made.faults.note);
  }
  return made;
}

}  // namespace

Json server_json(const std::optional<ServerSpec>& server) {
  if (!server) return nullptr;
  return {{"kind", server_kind_name(server->kind)},
          {"capacity_ns", server->capacity.count},
          {"period_ns", server->period.count}};
}

Json profile_json(std::span<const TaskProfile> tasks, Nanoseconds origin) {
  Json all = Json::array();
  for (const TaskProfile& task : tasks) all.push_back(json_of(task, origin));
  return all;
}

Result<std::vector<TaskProfile>> read_profiles(const Json& json, Nanoseconds origin) {
  try {
    if (!json.is_array()) throw JsonError("expected a list of tasks");
    std::vector<TaskProfile> tasks;
    for (const Json& task : json) tasks.push_back(profile_of(task, origin));
    return tasks;
  } catch (const std::exception& error) {
    return Error{ErrorCode::kBadInput, std::string_view(error.what()), std::string_view("profile")};
  }
}

}  // namespace chimera
