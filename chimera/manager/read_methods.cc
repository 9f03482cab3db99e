// SPDX-License-Identifier: Apache-2.0
// Answers status, readings, events and other questions from the state of the manager.
#include "chimera/manager/read_methods.h"

#include <algorithm>
#include <filesystem>

#include "chimera/base/hosted/wording.h"
#include "chimera/draw/graph_of.h"
#include "chimera/draw/picture.h"
#include "chimera/manager/act/operator_acts.h"
#include "chimera/manager/answer/large_readings.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/manager/answer/value_json.h"
#include "chimera/manager/subscription_feeds.h"
#include "chimera/platform/process_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {

using control::MethodId;
using control::RpcResponse;

namespace {

std::string working_folder() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
}

/// Makes an answer once: the bundle does not change while the manager lives.
template <class Make>
RpcResponse made_once(std::shared_ptr<const std::string>& text, Make make) {
  if (text == nullptr) text = std::make_shared<const std::string>(make().dump());
  return RpcResponse::ready(text);
}

}  // namespace

std::optional<RpcResponse> ReadMethods::answer(MethodId method, const Json& parameters, control::Role role) {
  switch (method) {
    case MethodId::kHello:
      return hello(role);
    case MethodId::kStatus:
      return RpcResponse::good(status_json(state_, now()));
    case MethodId::kDescribe:
      return describe(parameters);
    case MethodId::kGet:
      return get(parameters);
    case MethodId::kProfile:
      return RpcResponse::good(profile_json(state_, now()));
    case MethodId::kEvents:
      return events(parameters);
    case MethodId::kWhy:
      return why(parameters);
    case MethodId::kLibrary:
      return made_once(library_, [&] { return library_json(state_); });
    case MethodId::kText:
      return made_once(text_, [&] {
        const Bundle& bundle = state_.bundle;
        return Json{{"file", bundle.file}, {"text", bundle.is_idle() ? Json() : Json(bundle.description)}};
      });
    default:
      return std::nullopt;
  }
}

RpcResponse ReadMethods::describe(const Json& parameters) {
  const Json* name = parameters.find("configuration");
  if (!truth_at(parameters, "picture")) {
    if (name != nullptr)
      return RpcResponse::error(control::kBadParameters, "'configuration' needs 'picture'",
                                {{"where", "configuration"}});
    return made_once(descriptions_[""], [&] { return describe_json(state_); });
  }
  const ConfiguredSet* set = nullptr;
  if (name != nullptr) {
    const auto sets = state_.configuration ? state_.configuration->sets() : std::span<const ConfiguredSet>();
    const auto at = std::ranges::find(sets, name->as_string(), &ConfiguredSet::name);
    if (at == sets.end())
      return RpcResponse::no_such("configuration", name->as_string(), names_of(sets, &ConfiguredSet::name));
    set = &*at;
  }
  return made_once(descriptions_[set == nullptr ? "picture" : "picture " + set->name], [&] {
    Json description = describe_json(state_);
    description["picture"] =
        draw::picture_json(state_.configuration ? draw::graph_of(*state_.configuration, set) : draw::Graph{});
    return description;
  });
}

RpcResponse ReadMethods::hello(control::Role role) const {
  return RpcResponse::good({{"protocol", 1},
                            {"program", state_.bundle.program},
                            {"subsystem", state_.spec().name},
                            {"role", control::role_name(role)},
                            {"file", state_.bundle.file},
                            {"keeper_pid", state_.keeper_pid},
                            {"session", own_session()},  // session and folder are inherited from the keeper
                            {"folder", working_folder()},
                            {"manager", {{"pid", own_process_id()}, {"starts", state_.own.incarnation()}}}});
}

RpcResponse ReadMethods::get(const Json& parameters) const {
  const auto variables = variables_named(state_, control::texts(parameters, "variables"));
  if (const auto* refused = std::get_if<RpcResponse>(&variables)) return *refused;
  const auto& named = std::get<0>(variables);
  if (bytes_of(state_, named) <= kLargeReadings)
    return RpcResponse::good({{"values", readings_json(state_, named, now())}});
  return RpcResponse::in_pieces(std::make_shared<LargeReadings>(state_, named, R"({"values":)", "}"));
}

RpcResponse ReadMethods::events(const Json& parameters) const {
  const std::uint64_t asked = control::number(parameters, "limit", kEventsAtOnce);
  const std::uint64_t limit = std::min<std::uint64_t>(asked, kEventsAtOnce);
  return RpcResponse::good(events_json(state_, control::number(parameters, "since", 0), limit));
}

RpcResponse ReadMethods::why(const Json& parameters) const {
  const auto variables = variables_named(state_, {parameters.at("variable").as_string()});
  if (const auto* refused = std::get_if<RpcResponse>(&variables)) return *refused;
  return RpcResponse::good(why_json(state_, std::get<0>(variables)[0], now()));
}

}  // namespace chimera::manager
