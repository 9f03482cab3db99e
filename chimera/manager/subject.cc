// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/subject.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "chimera/manager/cause.h"
#include "chimera/manager/command_text.h"
#include "chimera/manager/subject_acts.h"
#include "chimera/manager/subject_status.h"
#include "chimera/manager/subject_values.h"
#include "chimera/text/nearest.h"

namespace chimera::manager {
namespace {

using control::Answer;
using control::Json;

constexpr std::size_t kEventsAtOnce = 1000;
constexpr const char* kSignals[] = {"spawn", "on", "off", "kill", "clear", "reinit"};

std::vector<std::string> texts(const Json& parameters, const char* key) {
  const auto found = parameters.find(key);
  return found == parameters.end() ? std::vector<std::string>() : found->get<std::vector<std::string>>();
}

std::uint64_t number(const Json& parameters, const char* key, std::uint64_t otherwise) {
  const auto found = parameters.find(key);
  return found == parameters.end() ? otherwise : found->get<std::uint64_t>();
}

std::string working_folder() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
}

std::shared_ptr<const Json> shared(Json json) { return std::make_shared<const Json>(std::move(json)); }

}  // namespace

void Subject::call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
                   control::Reply reply) {
  const std::string_view name = method.name;
  if (name == "signal") return signal(parameters, reply);
  if (name == "check") return analyse(Question::Kind::kCheck, parameters, caller.session, std::move(reply));
  if (name == "schedule") return analyse(Question::Kind::kSchedule, parameters, caller.session, std::move(reply));
  reply(answer(name, parameters, caller.role));
}

void Subject::analyse(Question::Kind kind, const Json& parameters, std::uint64_t session, control::Reply reply) {
  Question question{kind, parameters.value("file", std::string("text")), parameters.at("text")};
  if (questions_ != nullptr) return questions_->ask(std::move(question), session, std::move(reply), now());
  reply(Answer::ready(std::make_shared<const std::string>(answer_of(question, world().bundle.library))));
}

/// What the bundle says is the same as long as the manager lives.
Answer Subject::always(std::shared_ptr<const std::string>& text, Json (*make)(const World&)) const {
  if (text == nullptr)
    text = std::make_shared<const std::string>(make(world()).dump(-1, ' ', false, Json::error_handler_t::replace));
  return Answer::ready(text);
}

Answer Subject::answer(std::string_view method, const Json& parameters, control::Role role) {
  if (method == "hello") return hello(role);
  if (method == "status") return Answer::good(status_json(world(), now()));
  if (method == "describe") return always(description_, describe_json);
  if (method == "get") return get(parameters);
  if (method == "profile") return Answer::good(profile_json(world(), now()));
  if (method == "events") return events(parameters);
  if (method == "why") return why(parameters);
  if (method == "library") return always(library_, library_json);
  if (method == "ring") return ring(parameters);
  if (method == "set") return set_values(world(), parameters.at("values"));
  if (method == "flag") return set_flag(world(), parameters.at("up"));
  if (method == "save") return saved_values(world());
  if (method == "end") return end(parameters);
  return Answer::error(control::kNoMethod, "no method '" + std::string(method) + "'");
}

Answer Subject::hello(control::Role role) const {
  return Answer::good({{"protocol", 1},
                       {"program", world().bundle.program},
                       {"subsystem", world().spec().name},
                       {"role", control::role_name(role)},
                       {"file", world().bundle.file},
                       {"keeper_pid", world().keeper_pid},
                       {"session", ::getsid(0)},  // the keeper's, as is the folder: both are inherited
                       {"folder", working_folder()},
                       {"manager", {{"pid", ::getpid()}, {"starts", world().own.incarnation()}}}});
}

Answer Subject::get(const Json& parameters) const {
  const auto variables = variables_named(world(), texts(parameters, "variables"));
  if (const auto* refused = std::get_if<Answer>(&variables)) return *refused;
  return Answer::good({{"values", readings_json(world(), std::get<0>(variables), now())}});
}

Answer Subject::events(const Json& parameters) const {
  const std::uint64_t limit = std::min<std::uint64_t>(number(parameters, "limit", kEventsAtOnce), kEventsAtOnce);
  return Answer::good(events_json(world(), number(parameters, "since", 0), limit));
}

Answer Subject::why(const Json& parameters) const {
  const auto variables = variables_named(world(), {parameters.at("variable").get<std::string>()});
  if (const auto* refused = std::get_if<Answer>(&variables)) return *refused;
  return Answer::good(why_json(world(), std::get<0>(variables)[0], now()));
}

Answer Subject::end(const Json& parameters) {
  driver_.end(static_cast<std::int32_t>(std::min<std::uint64_t>(number(parameters, "code", 0), 255)));
  return Answer::good(Json::object());
}

void Subject::signal(const Json& parameters, const control::Reply& reply) {
  const std::string name = parameters.at("signal");
  const auto at = std::find(std::begin(kSignals), std::end(kSignals), name);
  if (at == std::end(kSignals)) {
    const std::string near = nearest(name, std::vector<std::string>(std::begin(kSignals), std::end(kSignals)));
    return reply(Answer::unknown("no signal '" + name + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"),
                                 name, near));
  }
  auto tasks = tasks_named(world(), texts(parameters, "tasks"));
  if (const auto* refused = std::get_if<Answer>(&tasks)) return reply(*refused);
  if (world().keeper.ending.load(std::memory_order_acquire) != 0)
    return reply(Answer::error(control::kEnding, "everything ends"));
  driver_.command(static_cast<Signal>(at - std::begin(kSignals)), std::get<0>(std::move(tasks)),
                  [this, reply](const subsystem::Answer& said) { reply(told(said)); });
}

/// What became of a signal, as the protocol has it.
Answer Subject::told(const subsystem::Answer& said) const {
  if (said.accepted) {
    Json tasks = Json::array();
    for (const subsystem::Outcome& outcome : said.outcomes) {
      tasks.push_back({{"task", world().name(outcome.task)},
                       {"before", state_name(outcome.before)},
                       {"after", state_name(outcome.after)}});
      if (outcome.is_already) tasks.back()["already"] = true;
    }
    return Answer::good({{"tasks", std::move(tasks)}});
  }
  const std::string where = said.at.is_valid() ? world().name(said.at) : "";
  if (said.at.is_valid() && said.text.starts_with("no answer from"))
    return no_answer(world().spec().tasks[said.at.index].rtpu, said.text);
  Json data = {{"where", where}};
  for (const char* begins : {"the smallest legal set is", "type `chimera "})
    if (const std::size_t remedy = said.text.find(begins); remedy != std::string::npos)
      data["remedy"] = said.text.substr(remedy);
  return Answer::error(control::kRefused, said.text, data);
}

Answer Subject::no_answer(RtpuId rtpu, const std::string& text) const {
  const PeerSegment& segment = world().peers[rtpu];
  const std::string running = segment.is_there() ? running_text(world().spec(), segment.block().head().running) : "";
  return Answer::error(control::kNoAnswer, text,
                       {{"rtpu", world().name(rtpu)}, {"running", running.empty() ? Json() : Json(running)}});
}

Answer Subject::ring(const Json& parameters) {
  const auto named = tasks_named(world(), texts(parameters, "tasks"));
  if (const auto* refused = std::get_if<Answer>(&named)) return *refused;
  const auto& tasks = std::get<0>(named);
  if (world().keeper.ending.load(std::memory_order_acquire) != 0)
    return Answer::error(control::kEnding, "everything ends");
  const std::string words = command_text(world().spec(), Signal::kWakeup, tasks);
  const auto refused = [&](const Answer& answer, TaskId task) {
    world().tell("command", task, RtpuId{}, words + ": refused: " + answer.message, now());
    return answer;
  };
  for (const TaskId task : tasks)
    if (const Answer judged = judge_ring(world(), task); !judged.is_good()) return refused(judged, task);
  if (const RtpuId full = driver_.ring(tasks); full.is_valid())
    return refused(no_answer(full, "no answer from rtpu " + world().name(full)), TaskId{});
  world().tell("command", TaskId{}, RtpuId{}, words + ": done", now());
  Json names = Json::array();
  for (const TaskId task : tasks) names.push_back(world().name(task));
  return Answer::good({{"tasks", std::move(names)}});
}

Answer Subject::open(std::uint64_t subscription, const Json& parameters) {
  using To = Subscription::To;
  const std::string to = parameters.at("to");
  auto variables = variables_named(world(), texts(parameters, "variables"));
  if (const auto* refused = std::get_if<Answer>(&variables)) return *refused;
  Subscription made;
  made.to = to == "status" ? To::kStatus : to == "events" ? To::kEvents : to == "values" ? To::kValues : To::kTap;
  if (made.to == To::kEvents) made.next = number(parameters, "since", world().log.last() + 1);
  if (made.to == To::kValues)
    made.variables = std::get<0>(std::move(variables));
  else if (made.to == To::kTap)
    made.tap = std::make_unique<TapFeed>(world(),
                                         parameters.contains("variables") && !parameters["variables"].empty()
                                             ? std::get<0>(std::move(variables))
                                             : std::vector<VariableId>(),
                                         number(parameters, "since", 1) == 0);
  subscriptions_[subscription] = std::move(made);
  return Answer{};
}

std::shared_ptr<const Json> Subject::pull(std::uint64_t subscription) {
  Subscription& wanted = subscriptions_.at(subscription);
  const Nanoseconds at = now();
  switch (wanted.to) {
    case Subscription::To::kStatus:
      return shared(status_json(world(), at));
    case Subscription::To::kValues:
      return shared({{"at_ns", at.count}, {"values", readings_json(world(), wanted.variables, at)}});
    case Subscription::To::kEvents:
      return pull_events(wanted);
    case Subscription::To::kTap:
      break;
  }
  return pull_tap(wanted);
}

std::shared_ptr<const Json> Subject::pull_events(Subscription& subscription) const {
  const EventLog& log = world().log;
  const std::uint64_t from = std::max<std::uint64_t>(subscription.next, 1);
  if (from > log.last()) return nullptr;
  Json found = events_json(world(), from, kEventsAtOnce);
  const std::uint64_t lost = log.first() > from ? log.first() - from : 0;
  subscription.next = std::max(from, log.first()) + found["events"].size();
  return shared({{"events", std::move(found["events"])}, {"lost", lost}});
}

std::shared_ptr<const Json> Subject::pull_tap(Subscription& subscription) const {
  // The tap is read again when all of this is taken: what a slow reader leaves there is overwritten and counted.
  if (subscription.waiting.empty())
    subscription.tap->pump([&](Json message) { subscription.waiting.push_back(shared(std::move(message))); });
  if (subscription.waiting.empty()) return nullptr;
  auto message = std::move(subscription.waiting.front());
  subscription.waiting.pop_front();
  return message;
}

}  // namespace chimera::manager
