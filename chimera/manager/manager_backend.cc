// SPDX-License-Identifier: Apache-2.0
// Carries out the methods of the control protocol: docs/formats/control.md.
#include "chimera/manager/manager_backend.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/manager/act/operator_acts.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/state/asker.h"
#include "chimera/manager/state/cause.h"
#include "chimera/manager/state/command_text.h"
#include "chimera/manager/subscription_feeds.h"
#include "chimera/manager/watch/guard_news.h"
#include "chimera/runtime/hosted/asked_set.h"
#include "chimera/text/json.h"
#include "chimera/text/json_text.h"

namespace chimera::manager {
namespace {

using control::MethodId;
using control::RpcResponse;
using subsystem::RefusalKind;

constexpr const char* kSignals[] = {signal_name(Signal::kSpawn), signal_name(Signal::kOn),
                                    signal_name(Signal::kOff),   signal_name(Signal::kKill),
                                    signal_name(Signal::kClear), signal_name(Signal::kReinit)};

/// The slow method in which the rtpu hangs, and what a person can do; "" if none is known. For a hang in `cycle`, the
/// data of the error names the method.
std::string under_way(const ManagerState& state, RtpuId rtpu) {
  const RtpuRecord& record = state.rtpus[rtpu.index];
  const PeerSegment& segment = state.peers[rtpu];
  const bool serves = segment.is_there() && segment.block().head().serving.load(std::memory_order_relaxed) != 0;
  if (!serves || !record.is_alive || record.hang.empty()) return "";
  return ": " + record.hang + "; it goes on: `chimera status` shows when it has ended, `kill -KILL " +
         std::to_string(record.pid) + "` ends the process of " + state.name(rtpu) +
         ", and the tasks that were ON come back";
}

/// Error -32006 with the method that the rtpu runs.
RpcResponse no_answer(const ManagerState& state, RtpuId rtpu, const std::string& text) {
  const PeerSegment& segment = state.peers[rtpu];
  const std::string running = segment.is_there() ? running_text(state.spec(), segment.block().head().running) : "";
  const std::string why = under_way(state, rtpu);
  return RpcResponse::error(control::kNoAnswer, text + why,
                       {{"rtpu", state.name(rtpu)}, {"running", running.empty() ? Json() : Json(running)}});
}

std::variant<WantedTasks, RpcResponse> named_set(const ApplicationSpec& spec, const std::string& name) {
  const auto set = std::ranges::find(spec.sets, std::string_view(name), &NamedSet::name);
  const auto number = static_cast<std::uint32_t>(set - spec.sets.begin());
  if (number < spec.sets.size()) return WantedTasks{tasks_of(spec, number), {}};
  return RpcResponse::no_such("configuration", name, names_of(spec.sets, &NamedSet::name));
}

/// The tasks that `switch` requests: a configuration, or the tasks that are ON plus `on` minus `off`.
std::variant<WantedTasks, RpcResponse> wanted_tasks(const ManagerState& state, const Json& parameters) {
  const bool is_named = parameters.contains("configuration");
  const bool is_listed = parameters.contains("on") || parameters.contains("off");
  if (is_named == is_listed)
    return RpcResponse::error(control::kBadParameters, "either 'configuration', or 'on' and 'off'",
                              {{"where", is_named ? "configuration" : "on"}});
  if (is_named) return named_set(state.spec(), parameters.at("configuration").as_string());
  TaskLists lists;
  for (const char* const key : {"on", "off"}) {
    if (!parameters.contains(key)) continue;
    auto found = tasks_named(state, control::texts(parameters, key));
    if (auto* refused = std::get_if<RpcResponse>(&found)) return std::move(*refused);
    (key == std::string_view("on") ? lists.plus : lists.minus) = bits_of(std::get<0>(found));
  }
  AskedSet asked = asked_set(state.spec(), state.tasks_on(), lists);
  if (asked) return WantedTasks{asked.tasks, lists};
  return RpcResponse::refused("set", asked.why, "", asked.remedy);
}

}  // namespace

RpcResponse signal_answer(const ManagerState& state, const subsystem::CommandAnswer& answer) {
  if (answer.is_accepted()) {
    Json tasks = Json::array();
    for (const subsystem::TaskOutcome& outcome : answer.outcomes) {
      tasks.push_back({{"task", state.name(outcome.task)},
                       {"before", state_name(outcome.before)},
                       {"after", state_name(outcome.after)}});
      if (outcome.is_already) tasks.elements().back()["already"] = true;
    }
    return RpcResponse::good({{"tasks", std::move(tasks)}});
  }
  const auto& [kind, reason, remedy, to_turn_on] = answer.refusal;
  if (kind == RefusalKind::kNoAnswer && answer.at.is_valid())
    return no_answer(state, state.spec().tasks[answer.at.index].rtpu, answer.refusal.text());
  return RpcResponse::refused(subsystem::refusal_kind_name(kind), answer.refusal.text(),
                              answer.at.is_valid() ? state.name(answer.at) : "", remedy,
                              names_of(to_turn_on, [&state](TaskId task) { return state.name(task); }));
}

RpcResponse switch_answer(const ManagerState& state, const SwitchOutcome& outcome) {
  const SwitchReceipt& receipt = outcome.receipt;
  const bool is_named = receipt.after != kNoSet;
  const Json to = is_named ? Json(std::string(state.spec().sets[receipt.after].name)) : Json();
  if (receipt.end == SwitchEnd::kNothingToDo) return RpcResponse::good({{"to", to}, {"end", "nothing-to-do"}});
  if (receipt.end != SwitchEnd::kRefused)
    return RpcResponse::ready(std::make_shared<const std::string>(outcome.json));
  const std::string what = "switch to " + control::set_text(receipt.after, state.spec()) + " is refused: " +
                           control::reason_text(receipt, state.spec());
  return RpcResponse::refused(control::reason_word(receipt.why), what,
                              receipt.task.is_valid() ? state.name(receipt.task) : "", outcome.remedy);
}

Json drill_json(const ManagerState& state, const DrillOutcome& outcome) {
  Json tasks = Json::array();
  for (const DrillPart& part : outcome.tasks) {
    const bool is_safe = part.verdict == DrillVerdict::kSafe;
    tasks.push_back({{"task", state.name(part.task)},
                     {"verdict", verdict_word(part.verdict)},
                     {"after_ns", is_safe ? Json(part.after.count) : Json()}});
  }
  Json killed;
  if (const DrillKill& kill = outcome.killed; kill.rtpu.is_valid())
    killed = {{"rtpu", state.name(kill.rtpu)},
              {"is_told", kill.is_told},
              {"written", kill.good},
              {"lost", kill.bad},
              {"after_ns", kill.good > 0 ? Json(kill.after.count) : Json()}};
  return {{"safe", outcome.is_safe()},
          {"flag_ns", outcome.flag_for.count},
          {"tasks", std::move(tasks)},
          {"killed", std::move(killed)}};
}

Json plan_json(const ManagerState& state, const ForeseenSwitch& foreseen) {
  const SwitchReceipt& receipt = foreseen.receipt;
  const ApplicationSpec& spec = state.spec();
  const auto names = [&](std::span<const TaskId> tasks) {
    Json list = Json::array();
    for (const TaskId task : tasks) list.push_back(state.name(task));
    return list;
  };
  Json variables = Json::array();
  for (const Handover& handover : foreseen.plan.handovers)
    variables.push_back({{"variable", spec.variables[handover.variable.index].name},
                         {"from", handover.from.task.is_valid() ? Json(state.name(handover.from.task)) : Json()},
                         {"to", state.name(handover.to.task)}});
  Json late_off;
  if (foreseen.late_off.is_valid())
    late_off = {{"task", state.name(foreseen.late_off)}, {"needs_ns", foreseen.needed.count}};
  const bool is_refused = receipt.end == SwitchEnd::kRefused;
  return {{"from", receipt.before == kNoSet ? Json() : Json(spec.sets[receipt.before].name)},
          {"to", receipt.after == kNoSet ? Json() : Json(spec.sets[receipt.after].name)},
          {"end", is_refused ? "refused" : receipt.end == SwitchEnd::kNothingToDo ? "nothing-to-do" : "possible"},
          {"reason", is_refused ? Json(control::reason_word(receipt.why)) : Json()},
          {"why", is_refused ? Json(control::reason_text(receipt, spec)) : Json()},
          {"remedy", foreseen.remedy.empty() ? Json() : Json(foreseen.remedy)},
          {"way", receipt.way.slow != 0 ? "slow" : "fast"},
          {"slow_because", control::slow_words(receipt.way)},
          {"slow_why", receipt.way.slow != 0 ? Json(control::slow_text(receipt, spec)) : Json()},
          {"expected_ns", foreseen.expected.count},
          {"late_off", std::move(late_off)},
          {"arrives", names(foreseen.plan.arriving)},
          {"leaves", names(foreseen.plan.leaving)},
          {"stays", names(foreseen.plan.staying)},
          {"variables", std::move(variables)}};
}

RpcResponse receipts_answer(const ReceiptArchive& archive, std::size_t n) {
  const auto or_null = [](const std::string& text) { return text.empty() ? "null" : json_string(text); };
  const std::deque<std::string>& kept = archive.kept();
  const std::size_t n_given = std::min(n, kept.size()), first = kept.size() - n_given;
  const std::string list = join_n(n_given, ", ", [&kept, first](std::size_t i) { return kept[first + i]; });
  return RpcResponse::ready(std::make_shared<const std::string>(
      "{\"receipts\": [" + list + "], \"file\": " + or_null(archive.path()) + ", \"unfiled\": " +
      std::to_string(archive.unfiled()) + ", \"fault\": " + or_null(archive.fault()) + "}"));
}

/// ControlServer carries out `subscribe` and `unsubscribe`.
void ManagerBackend::call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
                          control::Reply reply) {
  if (const auto answer = reads_.answer(method.id, parameters, caller.role)) return reply(*answer);
  const Request request{parameters, caller, reply};
  const Acting acting(state(), Asker{caller.role, caller.user}.text());
  switch (method.id) {
    case MethodId::kReceipts: return receipts(request);
    case MethodId::kPlan: return plan(request);
    case MethodId::kCheck: return analyse(Question::Kind::kCheck, request);
    case MethodId::kSchedule: return analyse(Question::Kind::kSchedule, request);
    case MethodId::kSignal: return signal(request);
    case MethodId::kRing: return ring(request);
    case MethodId::kSet: return reply(set_values(state(), parameters.at("values")));
    case MethodId::kFlag: return reply(set_flag(state(), parameters.at("up").as_bool()));
    case MethodId::kSwitch: return switch_to(request);
    case MethodId::kCancel: return cancel(request);
    case MethodId::kDrill: return drill(request);
    case MethodId::kSave: return reply(saved_values(state()));
    case MethodId::kEnd: return end(request);
    default: return reply(bench_alone());  // control::is_of_bench()
  }
}

void ManagerBackend::analyse(Question::Kind kind, const Request& request) {
  Question question{kind, text_at(request.parameters, "file", "text"), request.parameters.at("text").as_string()};
  if (questions_ != nullptr)
    return questions_->ask(
        std::move(question), request.caller.connection,
        [reply = request.reply](const RpcResponse& answer, std::string_view) { reply(answer); }, now());
  const auto answer = answer_of(question, state().bundle.library);
  request.reply(RpcResponse::ready(std::make_shared<const std::string>(answer->json)));
}

void ManagerBackend::signal(const Request& request) {
  const std::string& name = request.parameters.at("signal").as_string();
  const auto at = std::ranges::find(kSignals, name);
  if (at == std::end(kSignals))
    return request.reply(RpcResponse::no_such("signal", name, names_of(kSignals, std::identity())));
  auto tasks = tasks_named(state(), control::texts(request.parameters, "tasks"));
  if (const auto* refused = std::get_if<RpcResponse>(&tasks)) return request.reply(*refused);
  if (state().is_ending()) return request.reply(RpcResponse::error(control::kEnding, "the subsystem is ending"));
  const auto wanted = static_cast<Signal>(at - std::begin(kSignals));
  if (wanted == Signal::kOn && loop_.switches().is_under_way())
    return request.reply(RpcResponse::refused("under-way", loop_.switches().under_way() + ", is under way", "",
                                              loop_.switches().way_out()));
  loop_.command(wanted, std::get<0>(std::move(tasks)),
                  [this, reply = request.reply](const subsystem::CommandAnswer& answer) {
                    reply(signal_answer(state(), answer));
                  });
}

void ManagerBackend::ring(const Request& request) {
  const auto named = tasks_named(state(), control::texts(request.parameters, "tasks"));
  if (const auto* refused = std::get_if<RpcResponse>(&named)) return request.reply(*refused);
  const auto& tasks = std::get<0>(named);
  if (state().is_ending()) return request.reply(RpcResponse::error(control::kEnding, "the subsystem is ending"));
  const std::string words = command_text(state().spec(), Signal::kWakeup, tasks);
  const auto refuse = [&](const RpcResponse& answer, TaskId task) {
    state().tell("command", task, RtpuId{}, words + ": refused: " + answer.message, now());
    request.reply(answer);
  };
  for (const TaskId task : tasks)
    if (const RpcResponse judged = judge_ring(state(), task); !judged.is_good()) return refuse(judged, task);
  if (const RtpuId full = loop_.ring(tasks); full.is_valid())
    return refuse(no_answer(state(), full, "no answer from rtpu " + state().name(full)), TaskId{});
  state().tell("command", TaskId{}, RtpuId{}, words + ": done", now());
  Json names = Json::array();
  for (const TaskId task : tasks) names.push_back(state().name(task));
  request.reply(RpcResponse::good({{"tasks", std::move(names)}}));
}

void ManagerBackend::receipts(const Request& request) {
  request.reply(receipts_answer(loop_.receipts(), control::number(request.parameters, "last", 20)));
}

/// The requested set of tasks. None: the answer with the refusal has been sent.
std::optional<WantedTasks> ManagerBackend::wanted(const Request& request) const {
  auto found = wanted_tasks(state(), request.parameters);
  if (const auto* refused = std::get_if<RpcResponse>(&found)) {
    request.reply(*refused);
    return std::nullopt;
  }
  return std::get<WantedTasks>(found);
}

void ManagerBackend::plan(const Request& request) {
  const auto to = wanted(request);
  if (!to) return;
  request.reply(RpcResponse::good(plan_json(state(), loop_.switches().foresee(to->target))));
}

void ManagerBackend::cancel(const Request& request) {
  SwitchCoordinator& switches = loop_.switches();
  if (!switches.is_under_way())
    return request.reply(RpcResponse::refused("no-switch", "no switch is under way", ""));
  const auto answer = [this, reply = request.reply](const SwitchOutcome& outcome) {
    reply(switch_answer(state(), outcome));
  };
  if (!switches.cancel({request.caller.role, request.caller.user}, answer))
    request.reply(RpcResponse::refused(
        "too-late", switches.under_way() + ", cannot be cancelled: it is " + switches.progress(), "",
        switches.way_out()));
}

void ManagerBackend::switch_to(const Request& request) {
  const auto to = wanted(request);
  if (!to) return;
  if (state().is_ending()) return request.reply(RpcResponse::error(control::kEnding, "the subsystem is ending"));
  const std::uint64_t wait_ms = control::number(request.parameters, "wait_ms", 10'000);
  const Nanoseconds wait = milliseconds(static_cast<std::int64_t>(wait_ms));
  loop_.switch_to(to->target, to->lists.minus, {request.caller.role, request.caller.user}, wait, now(),
                  [this, reply = request.reply](const SwitchOutcome& outcome) {
                    reply(switch_answer(state(), outcome));
                  });
}

void ManagerBackend::drill(const Request& request) {
  const auto refuse = [&](const char* kind, const std::string& why, const std::string& remedy) {
    request.reply(RpcResponse::refused(kind, "the drill is refused: " + why, "", remedy));
  };
  if (state().is_ending()) return request.reply(RpcResponse::error(control::kEnding, "the subsystem is ending"));
  if (loop_.drill().is_under_way())
    return refuse("under-way", "another one is under way", "ask again when it is over");
  if (loop_.switches().is_under_way())
    return refuse("under-way", loop_.switches().under_way() + ", is under way", loop_.switches().way_out());
  if (!state().logic.is_settled())
    return refuse("under-way", "tasks are being brought up",
                  loop_.switches().way_out("`chimera status` shows which; ask again when they are ON"));
  if (const Json flag = flag_json(state()); truth_at(flag, "up"))
    return refuse("flag-up", "the flag is up already, so it would measure nothing", "`chimera status` says by whom");
  const std::uint64_t wait_ms = control::number(request.parameters, "wait_ms", 10'000);
  const Nanoseconds wait = milliseconds(static_cast<std::int64_t>(wait_ms));
  RtpuId to_kill;
  if (request.parameters.contains("kill")) {
    const std::string& name = request.parameters.at("kill").as_string();
    const auto names = names_of(state().spec().rtpus, &RtpuSpec::name);
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) return request.reply(RpcResponse::no_such("rtpu", name, names));
    to_kill = RtpuId(static_cast<std::size_t>(at - names.begin()));
    if (const NoGuard lack = no_guard(state(), to_kill); !lack.why.empty())
      return refuse("no-guard", lack.why, lack.remedy);
  }
  loop_.drill().begin(wait, to_kill, now(), [this, reply = request.reply](const DrillOutcome& outcome) {
    reply(RpcResponse::good(drill_json(state(), outcome)));
  });
}

void ManagerBackend::end(const Request& request) {
  state().tell("command", TaskId{}, RtpuId{}, "end: done", now());
  loop_.end(static_cast<std::int32_t>(std::min<std::uint64_t>(control::number(request.parameters, "code", 0), 255)));
  request.reply(RpcResponse::good(Json::object()));
}

}  // namespace chimera::manager
