// SPDX-License-Identifier: Apache-2.0
// Carries out the methods of the control protocol: docs/formats/control.md.
#include "chimera/manager/manager_backend.h"


#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "chimera/platform/process_id.h"
#include "chimera/text/nearest.h"
#include "chimera/manager/command_text.h"
#include "chimera/manager/large_readings.h"
#include "chimera/manager/operator_acts.h"
#include "chimera/manager/parameters.h"
#include "chimera/manager/signal_answer.h"
#include "chimera/manager/status_json.h"
#include "chimera/manager/value_json.h"

namespace chimera::manager {
namespace {

using control::Json;
using control::MethodId;
using control::RpcResponse;

constexpr const char* kSignals[] = {signal_name(Signal::kSpawn), signal_name(Signal::kOn),
                                    signal_name(Signal::kOff),   signal_name(Signal::kKill),
                                    signal_name(Signal::kClear), signal_name(Signal::kReinit)};

std::string working_folder() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
}

}  // namespace

/// `subscribe` and `unsubscribe` are carried out by the door.
ManagerBackend::Handler ManagerBackend::handler(MethodId method) noexcept {
  using Me = ManagerBackend;
  static constexpr struct {
    MethodId method;
    Handler handler;
  } kHandlers[] = {
      {MethodId::kHello, &Me::hello},     {MethodId::kStatus, &Me::status},   {MethodId::kDescribe, &Me::describe},
      {MethodId::kGet, &Me::get},         {MethodId::kProfile, &Me::profile}, {MethodId::kEvents, &Me::events},
      {MethodId::kWhy, &Me::why},         {MethodId::kCheck, &Me::check},     {MethodId::kSchedule, &Me::schedule},
      {MethodId::kLibrary, &Me::library}, {MethodId::kSignal, &Me::signal},   {MethodId::kRing, &Me::ring},
      {MethodId::kSet, &Me::set},         {MethodId::kFlag, &Me::flag},       {MethodId::kSave, &Me::save},
      {MethodId::kEnd, &Me::end},
  };
  const auto row = std::ranges::find_if(kHandlers, [method](const auto& one) { return one.method == method; });
  return row == std::end(kHandlers) ? &Me::unknown : row->handler;
}

void ManagerBackend::call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
                          control::Reply reply) {
  (this->*handler(method.id))({parameters, caller, reply});
}

void ManagerBackend::unknown(const Request& request) {
  request.reply(RpcResponse::error(control::kNoMethod, "a running subsystem has no such method"));
}

void ManagerBackend::analyse(Question::Kind kind, const Request& request) {
  Question question{kind, request.parameters.value("file", std::string("text")), request.parameters.at("text")};
  if (questions_ != nullptr)
    return questions_->ask(std::move(question), request.caller.connection, request.reply, now());
  request.reply(RpcResponse::ready(std::make_shared<const std::string>(answer_of(question, world().bundle.library))));
}

/// What the bundle says does not change as long as the manager lives.
RpcResponse ManagerBackend::always(std::shared_ptr<const std::string>& text, Json (*make)(const ManagerState&)) const {
  if (text == nullptr)
    text = std::make_shared<const std::string>(make(world()).dump(-1, ' ', false, Json::error_handler_t::replace));
  return RpcResponse::ready(text);
}

void ManagerBackend::hello(const Request& request) {
  request.reply(RpcResponse::good({{"protocol", 1},
                                   {"program", world().bundle.program},
                                   {"subsystem", world().spec().name},
                                   {"role", control::role_name(request.caller.role)},
                                   {"file", world().bundle.file},
                                   {"keeper_pid", world().keeper_pid},
                                   {"session", own_session()},  // the keeper's, as is the folder: both are inherited
                                   {"folder", working_folder()},
                                   {"manager", {{"pid", own_process_id()}, {"starts", world().own.incarnation()}}}}));
}

void ManagerBackend::status(const Request& request) { request.reply(RpcResponse::good(status_json(world(), now()))); }

void ManagerBackend::describe(const Request& request) { request.reply(always(description_, describe_json)); }

void ManagerBackend::library(const Request& request) { request.reply(always(library_, library_json)); }

void ManagerBackend::profile(const Request& request) { request.reply(RpcResponse::good(profile_json(world(), now()))); }

void ManagerBackend::get(const Request& request) {
  const auto variables = variables_named(world(), texts(request.parameters, "variables"));
  if (const auto* refused = std::get_if<RpcResponse>(&variables)) return request.reply(*refused);
  const auto& named = std::get<0>(variables);
  if (bytes_of(world(), named) <= kLargeReadings)
    return request.reply(RpcResponse::good({{"values", readings_json(world(), named, now())}}));
  request.reply(RpcResponse::in_pieces(std::make_shared<LargeReadings>(world(), named, R"({"values":)", "}")));
}

void ManagerBackend::events(const Request& request) {
  const std::uint64_t asked = number(request.parameters, "limit", kEventsAtOnce);
  const std::uint64_t limit = std::min<std::uint64_t>(asked, kEventsAtOnce);
  request.reply(RpcResponse::good(events_json(world(), number(request.parameters, "since", 0), limit)));
}

void ManagerBackend::why(const Request& request) {
  const auto variables = variables_named(world(), {request.parameters.at("variable").get<std::string>()});
  if (const auto* refused = std::get_if<RpcResponse>(&variables)) return request.reply(*refused);
  request.reply(RpcResponse::good(why_json(world(), std::get<0>(variables)[0], now())));
}

void ManagerBackend::signal(const Request& request) {
  const std::string name = request.parameters.at("signal");
  const auto at = std::ranges::find(kSignals, name);
  if (at == std::end(kSignals)) {
    const std::string near = nearest(name, std::vector<std::string>(std::begin(kSignals), std::end(kSignals)));
    return request.reply(RpcResponse::unknown(
        "no signal '" + name + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"), name, near));
  }
  auto tasks = tasks_named(world(), texts(request.parameters, "tasks"));
  if (const auto* refused = std::get_if<RpcResponse>(&tasks)) return request.reply(*refused);
  if (world().is_ending()) return request.reply(RpcResponse::error(control::kEnding, "the subsystem is ending"));
  driver_.command(static_cast<Signal>(at - std::begin(kSignals)), std::get<0>(std::move(tasks)),
                  [this, reply = request.reply](const subsystem::CommandAnswer& answer) {
                    reply(signal_answer(world(), answer));
                  });
}

void ManagerBackend::ring(const Request& request) {
  const auto named = tasks_named(world(), texts(request.parameters, "tasks"));
  if (const auto* refused = std::get_if<RpcResponse>(&named)) return request.reply(*refused);
  const auto& tasks = std::get<0>(named);
  if (world().is_ending()) return request.reply(RpcResponse::error(control::kEnding, "the subsystem is ending"));
  const std::string words = command_text(world().spec(), Signal::kWakeup, tasks);
  const auto refuse = [&](const RpcResponse& answer, TaskId task) {
    world().tell("command", task, RtpuId{}, words + ": refused: " + answer.message, now());
    request.reply(answer);
  };
  for (const TaskId task : tasks)
    if (const RpcResponse judged = judge_ring(world(), task); !judged.is_good()) return refuse(judged, task);
  if (const RtpuId full = driver_.ring(tasks); full.is_valid())
    return refuse(no_answer(world(), full, "no answer from rtpu " + world().name(full)), TaskId{});
  world().tell("command", TaskId{}, RtpuId{}, words + ": done", now());
  Json names = Json::array();
  for (const TaskId task : tasks) names.push_back(world().name(task));
  request.reply(RpcResponse::good({{"tasks", std::move(names)}}));
}

void ManagerBackend::set(const Request& request) {
  request.reply(set_values(world(), request.parameters.at("values")));
}

void ManagerBackend::flag(const Request& request) { request.reply(set_flag(world(), request.parameters.at("up"))); }

void ManagerBackend::save(const Request& request) { request.reply(saved_values(world())); }

void ManagerBackend::end(const Request& request) {
  driver_.end(static_cast<std::int32_t>(std::min<std::uint64_t>(number(request.parameters, "code", 0), 255)));
  request.reply(RpcResponse::good(Json::object()));
}

}  // namespace chimera::manager
