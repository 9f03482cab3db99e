// SPDX-License-Identifier: Apache-2.0
// Writes rtpus, tasks, profiles and events as JSON.
#include "chimera/manager/answer/status_json.h"

#include <algorithm>
#include <map>
#include <vector>

#include "chimera/analysis/schedule_report.h"
#include "chimera/analysis/task_profile.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/manager/state/cause.h"
#include "chimera/manager/watch/face_watch.h"
#include "chimera/manager/watch/guard_news.h"
#include "chimera/platform/realtime.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

const char* phase_text(PeerPhase phase) {
  switch (phase) {
    case PeerPhase::kStarting:
      return "starting";
    case PeerPhase::kServing:
      return "serving";
    case PeerPhase::kEnding:
      return "ending";
    case PeerPhase::kEnded:
      break;
  }
  return "ended";
}

Json or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

/// The report of the rtpu on its rights, even if it was cut to its room.
std::string grant_of(const BlockHead& head) { return {head.grant, ::strnlen(head.grant, sizeof head.grant)}; }

bool is_given_up(const ManagerState& state, RtpuId rtpu) {
  return !state.rtpus[rtpu.index].is_alive && state.logic.is_given_up(rtpu) && !state.is_ending();
}

bool has_lost_tasks(const ManagerState& state, RtpuId rtpu) {
  for (std::uint32_t t = 0; t < state.peers.n_tasks(); ++t)
    if (state.spec().tasks[t].rtpu == rtpu && state.state(TaskId(t)) == State::kError) return true;
  return false;
}

/// True if no rtpu is left that could raise the flag for missing variables.
bool all_are_dead(const ManagerState& state) {
  return !state.is_ending() &&
         std::none_of(state.rtpus.begin(), state.rtpus.end(), [](const RtpuRecord& rtpu) { return rtpu.is_alive; });
}

Json rtpu_json(const ManagerState& state, RtpuId rtpu) {
  const RtpuSpec& spec = state.spec().rtpus[rtpu.index];
  const RtpuRecord& record = state.rtpus[rtpu.index];
  const PeerSegment& segment = state.peers[rtpu];
  const bool is_current = segment.is_there() && segment.incarnation() == record.incarnation;
  const PeerPhase phase = !record.is_alive ? PeerPhase::kEnded
                          : is_current     ? segment.block().head().phase.load(std::memory_order_acquire)
                                           : PeerPhase::kStarting;
  Json json = {{"name", spec.name},
               {"cpu", spec.cpu},
               {"policy", policy_name(spec.policy)},
               {"executor", spec.preemptive ? "preemptive" : "executive"},
               {"pid", record.pid},
               {"incarnation", record.incarnation},
               {"alive", record.is_alive && !record.is_away},
               {"phase", phase_text(phase)},
               {"grant", ""},
               {"running", nullptr},
               {"hang", or_null(record.hang)},
               {"restarts", record.restarts},
               {"last_end", or_null(record.last_end)},
               {"given_up", is_given_up(state, rtpu)},
               {"remedy", is_given_up(state, rtpu) ? or_null(state.logic.way_back(rtpu)) : Json()},
               {"lost_events", 0},
               {"resident_bytes", record.resident_bytes},
               {"first_resident_bytes", record.first_resident_bytes},
               {"not_real_time", Json()},
               {"lost_rights", record.is_alive ? or_null(record.lost_rights) : Json()},
               {"unguarded", or_null(unguarded_text(state, rtpu))},
               {"flag", false}};
  if (!segment.is_there()) return json;
  const BlockHead& head = segment.block().head();
  json["grant"] = grant_of(head);
  json["not_real_time"] = or_null(not_real_time(grant_of(head)).c_str());
  if (record.is_alive) json["running"] = or_null(running_text(state.spec(), head.running));
  json["lost_events"] = head.lost_posts.load(std::memory_order_relaxed);
  json["flag"] = head.flag.load(std::memory_order_relaxed) != 0;
  return json;
}

Json inputs_json(const ManagerState& state, TaskId task) {
  Json inputs = Json::array();
  for (const ConfiguredPort& port : state.configuration->tasks()[task.index].ports) {
    if (port.kind != CHIMERA_IN_VAR) continue;
    const auto variable = state.readings->find(port.variable);
    if (!variable) continue;
    const VariableReading reading = state.readings->read_header(*variable);
    const bool is_operators = state.readings->is_operators(*variable);  // holds until it is set: never old
    const bool is_there = reading.is_valid && reading.slot.sequence > 0;
    inputs.push_back({{"port", port.name},
                      {"variable", port.variable},
                      {"age_ns", is_operators ? Json(0)
                                 : is_there   ? Json(std::max(reading.age(now()), Nanoseconds{1}).count)
                                              : Json()}});
  }
  return inputs;
}

Json spread_json(const Spread& spread) {
  if (spread.count == 0) return {{"mean", 0}, {"max", 0}};
  return {{"mean", spread.mean().count}, {"max", spread.max.count}};
}

/// Time for which the task was ON. If it left ON without a report, only the time before its last `on` is known.
Nanoseconds on_time(const ManagerState& state, TaskId task, const Profile& profile, Nanoseconds at) {
  return state.state(task) == State::kOn ? profile.on_by(at) : profile.on_before;
}

Json task_json(const ManagerState& state, TaskId task, Nanoseconds at) {
  const TaskSpec& spec = state.spec().tasks[task.index];
  const TaskStatus status = state.peers.status(task);
  const Profile p = state.profile(task);
  const FaultRecord fault = state.fault(task);
  return {{"task", spec.name},
          {"component", spec.component},
          {"rtpu", state.name(spec.rtpu)},
          {"state", state_name(state.state(task))},
          {"in_service", status.in_service},
          {"incarnation", status.incarnation},
          {"standby_for", state.configuration ? or_null(state.configuration->tasks()[task.index].standby_for) : Json()},
          {"rate_hz", state.configuration ? state.configuration->tasks()[task.index].rate_hz : 0},
          {"period_ns", spec.period.count},
          {"budget_ns", spec.budget.count},
          {"server", server_json(spec.server)},
          {"has_doorbell", spec.has_doorbell()},
          {"on_ns", on_time(state, task, p, at).count},
          {"busy_ns", p.execution[CHIMERA_CYCLE].sum.count},
          {"cycles", p.cycles},
          {"execution_ns", spread_json(p.execution[CHIMERA_CYCLE])},
          {"response_ns", {{"max", p.response.count == 0 ? 0 : p.response.max.count}}},
          {"jitter_ns", p.start_delay.count == 0 ? 0 : (p.start_delay.max - p.start_delay.min).count},
          {"missed", p.missed},
          {"overrun", p.overrun},
          {"dropped", p.dropped},
          {"partial", p.partial},
          {"tolerated", p.tolerated},
          {"stale", p.stale},
          {"rejected", p.rejected},
          {"preempted", p.preempted},
          {"demoted", p.demoted},
          {"events", p.events},
          {"events_lost", p.events_lost},
          {"exhausted", p.exhausted},
          {"fault", or_null(fault_text(state, task))},
          {"faults", fault.count},
          {"inputs", state.configuration ? inputs_json(state, task) : Json::array()}};
}

Json port_json(const ConfiguredPort& port) {
  return {{"port", port.name}, {"kind", kind_name(port.kind)}, {"variable", port.variable}, {"type", port.type},
          {"unit", port.unit}, {"shape", port.shape}, {"frame", or_null(port.frame)}};
}

Json described_task(const ManagerState& state, const ConfiguredTask& task) {
  Json ports = Json::array();
  for (const ConfiguredPort& port : task.ports) ports.push_back(port_json(port));
  return {{"task", task.name},
          {"component", task.component},
          {"doc", task.doc},
          {"rtpu", state.name(RtpuId(task.rtpu))},
          {"rate_hz", task.rate_hz},
          {"aperiodic", task.is_aperiodic},
          {"hardware", task.is_hardware},
          {"standby_for", task.standby_for},
          {"stale_after_ns", task.stale_after.count},
          {"hot", task.is_hot},
          {"ports", std::move(ports)}};
}

/// The range that all consumers of the variable declare together; each limit is null if none declares it.
std::pair<Json, Json> range_of(const Configuration& configuration, const ConfiguredVariable& variable) {
  Json least, most;
  for (const PortRef& ref : variable.consumers) {
    const PortSpec& port = configuration.spec().tasks[ref.task].ports[ref.port];
    if (!port.has_range) continue;
    least = least.is_null() ? port.min : std::max(port.min, least.as_double());
    most = most.is_null() ? port.max : std::min(port.max, most.as_double());
  }
  return {std::move(least), std::move(most)};
}

Json described_variable(const Configuration& configuration, const ConfiguredVariable& variable) {
  const auto names = [&](const std::vector<PortRef>& refs) {
    Json all = Json::array();
    for (const PortRef& ref : refs) {
      const ConfiguredTask& task = configuration.tasks()[ref.task];
      all.push_back({{"task", task.name}, {"port", task.ports[ref.port].name}});
    }
    return all;
  };
  const bool is_operators = variable.is_given && !variable.is_constant && !variable.consumers.empty();
  auto [least, most] = is_operators ? range_of(configuration, variable) : std::pair<Json, Json>();
  return {{"variable", variable.name},
          {"constant", variable.is_constant},
          {"given", variable.is_given},
          {"operator", is_operators},
          {"least", std::move(least)},
          {"most", std::move(most)},
          {"type", variable.type},
          {"unit", variable.unit},
          {"shape", variable.shape},
          {"producers", names(variable.producers)},
          {"consumers", names(variable.consumers)}};
}

/// The switch that is not decided yet; null if there is none.
Json switch_json(const ManagerState& state) {
  const SwitchAgreement agreement(state.page.switching, state.keeper.origin);
  const PlanWord plan = agreement.plan();
  const ApplicationSpec& spec = state.spec();
  const auto order = plan.is_open() ? agreement.order(plan, spec.sets.size(), spec.tasks.size()) : std::nullopt;
  if (!order) return nullptr;
  return {{"to", order->after == kNoSet ? Json() : Json(spec.sets[order->after].name)},
          {"progress", phase_word(plan.phase)},
          {"deadline_ns", order->until.count}};
}

}  // namespace

Json flag_json(const ManagerState& state) {
  Json by = Json::array();
  for (std::uint32_t r = 0; r < state.peers.n_rtpus(); ++r) {
    const PeerSegment& segment = state.peers[RtpuId(r)];
    const bool raises = segment.is_there() && segment.block().head().flag.load(std::memory_order_acquire) != 0;
    if (raises || (all_are_dead(state) && has_lost_tasks(state, RtpuId(r)))) by.push_back(state.name(RtpuId(r)));
  }
  const std::uint32_t own = state.own.block().head().flag.load(std::memory_order_acquire);  // BlockHead
  if ((own & kOperatorFlag) != 0) by.push_back("operator");
  if ((own & kDrillFlag) != 0) by.push_back("drill");
  return {{"up", !by.empty()}, {"by", std::move(by)}};
}

std::string fault_text(const ManagerState& state, TaskId task) {
  const FaultRecord fault = state.fault(task);
  if (fault.count == 0) return "";
  return std::string(method_name(fault.method)) + ": " + fault.last.text;
}

const char* phase_word(SwitchPhase phase) {
  constexpr const char* kWords[] = {"aborted", "arming", "agreeing", "committed"};
  return kWords[static_cast<unsigned>(phase)];
}

std::string configuration_name(const ManagerState& state) {
  if (!state.configuration) return "";
  const ApplicationSpec& spec = state.spec();
  std::vector<bool> on(spec.tasks.size());  // states may change during this call
  for (std::size_t t = 0; t < on.size(); ++t) on[t] = state.state(TaskId(t)) == State::kOn;
  const auto is_on = [&](TaskId task) { return on[task.index]; };
  const std::uint32_t set = set_in_force(spec, is_on);
  return set == kNoSet ? "" : control::set_with_standbys(set, spec, is_on);
}

namespace {

/// Budgets of the tasks that cycle now, hot standbys among them, and the limit of their sum: for each CPU.
Json cpus_json(const ManagerState& state) {
  const ApplicationSpec& spec = state.spec();
  std::map<std::uint32_t, double> budgets;
  for (const RtpuSpec& rtpu : spec.rtpus) budgets[rtpu.cpu] = 0;
  std::vector<TaskId> on;
  for (std::uint32_t t = 0; t < state.peers.n_tasks(); ++t)
    if (state.state(TaskId(t)) == State::kOn) on.emplace_back(t);
  const std::vector<Together> whatever_stands_by = all_together(spec.standbys, on);
  for (const TaskId task : whatever_stands_by.front().tasks) {
    const TaskSpec& each = spec.tasks[task.index];
    budgets[spec.rtpus[each.rtpu.index].cpu] += load_of(each);
  }
  Json cpus = Json::array();
  for (const auto& [cpu, sum] : budgets)
    cpus.push_back({{"cpu", cpu}, {"budgets", sum}, {"capacity", kMaxUtilisation}});
  return cpus;
}

}  // namespace

Json status_json(const ManagerState& state, Nanoseconds at) {
  Json rtpus = Json::array(), tasks = Json::array();
  for (std::uint32_t r = 0; r < state.peers.n_rtpus(); ++r) rtpus.push_back(rtpu_json(state, RtpuId(r)));
  for (std::uint32_t t = 0; t < state.peers.n_tasks(); ++t) tasks.push_back(task_json(state, TaskId(t), at));
  const std::int64_t started = state.own.block().memory().started_at;
  return {{"subsystem", state.spec().name},
          {"configuration", configuration_name(state)},
          {"now_ns", at.count},
          {"origin_ns", state.keeper.origin.count},
          {"started_ns", started == 0 ? Json() : Json(started)},
          {"ending", state.is_ending()},
          {"flag", flag_json(state)},
          {"switch", switch_json(state)},
          {"keeper", {{"pid", state.keeper_pid}, {"hang", or_null(state.keeper_hang)}}},
          {"guard", guard_json(state)},
          {"face", face_json(state)},
          {"cpus", cpus_json(state)},
          {"rtpus", std::move(rtpus)},
          {"tasks", std::move(tasks)}};
}

Json describe_json(const ManagerState& state) {
  Json tasks = Json::array(), variables = Json::array(), sets = Json::array(), sequence;
  std::string start;
  if (state.configuration) {
    const Configuration& configuration = *state.configuration;
    for (const ConfiguredTask& task : configuration.tasks()) tasks.push_back(described_task(state, task));
    for (const ConfiguredVariable& v : configuration.variables())
      variables.push_back(described_variable(configuration, v));
    for (const ConfiguredSet& set : configuration.sets()) {
      Json names = Json::array();
      for (const TaskId task : set.order) names.push_back(state.name(task));
      sets.push_back({{"name", set.name}, {"tasks", std::move(names)}});
    }
    start = configuration.sets()[configuration.start()].name;
    sequence = sequence_json(configuration.draft().sequence);
  }
  return {{"tasks", std::move(tasks)},
          {"variables", std::move(variables)},
          {"configurations", std::move(sets)},
          {"start", start},
          {"sequence", std::move(sequence)}};
}

Json profile_json(const ManagerState& state, Nanoseconds at) {
  std::vector<TaskProfile> tasks;
  for (std::uint32_t t = 0; t < state.peers.n_tasks(); ++t) {
    const TaskSpec& spec = state.spec().tasks[t];
    const Profile profile = state.profile(TaskId(t));
    tasks.push_back({std::string(spec.name), std::string(spec.component), state.state(TaskId(t)), spec.period, profile,
                     state.fault(TaskId(t)), std::string(state.name(spec.rtpu)),
                     state.configuration ? transfer_of(*state.configuration, t) : TransferCost{},
                     on_time(state, TaskId(t), profile, at), spec.server});
  }
  return {{"tasks", chimera::profile_json(tasks, state.keeper.origin)}};
}

Json event_json(const ManagerState& state, const LoggedEvent& event) {
  Json json = {{"number", event.number},
               {"origin_ns", state.keeper.origin.count},
               {"at_ns", event.at.count},
               {"wall_ns", event.wall_ns},
               {"kind", event.kind},
               {"text", event.text}};
  if (event.task.is_valid()) json["task"] = state.name(event.task);
  if (event.rtpu.is_valid()) json["rtpu"] = state.name(event.rtpu);
  if (!event.by.empty()) json["by"] = event.by;
  return json;
}

Json events_json(const ManagerState& state, std::uint64_t since, std::size_t limit) {
  Json events = Json::array();
  const EventLog& log = state.log;
  for (std::uint64_t n = std::max(since, log.first()); n <= log.last() && events.size() < limit; ++n)
    events.push_back(event_json(state, log.at(n)));
  return {{"events", std::move(events)}, {"first", log.first()}, {"last", log.last()}};
}

Json library_json(const ManagerState& state) {
  Json components = Json::array();
  for (const LibraryEntry& entry : state.bundle.library.entries())
    components.push_back({{"name", entry.descriptor.name}, {"doc", entry.descriptor.doc}, {"file", entry.object_file}});
  return {{"components", std::move(components)}};
}

}  // namespace chimera::manager
