// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/methods.h"
#include "chimera/text/json.h"

#include <gtest/gtest.h>

namespace chimera::control {
namespace {

std::string judged(const char* method, const Json& parameters) {
  const RpcResponse answer = check_parameters(*find_method(method), parameters);
  if (answer.is_good()) return "";
  EXPECT_EQ(answer.code, kBadParameters);
  const std::string near = answer.detail("nearest");
  return answer.detail("where") + ": " + answer.message + (near.empty() ? "" : " (" + near + ")");
}

TEST(Methods, AcceptTheParametersOfTheTable) {
  EXPECT_EQ(judged("hello", Json::object()), "");
  EXPECT_EQ(judged("get", {{"variables", {"q", "qd"}}}), "");
  EXPECT_EQ(judged("events", {{"since", 0}, {"limit", 1000}}), "");
  EXPECT_EQ(judged("subscribe", {{"to", "tap"}, {"period_ms", 20}, {"variables", Json::array()}, {"since", 3u}}), "");
  EXPECT_EQ(judged("signal", {{"signal", "on"}, {"tasks", {"pid"}}}), "");
  EXPECT_EQ(judged("ring", {{"tasks", {"lamp", "lamp"}}}), "");
  EXPECT_EQ(judged("set", {{"values", {{"kp", {1, 2}}}}}), "");
  EXPECT_EQ(judged("end", {{"code", 255}}), "");
  EXPECT_EQ(judged("edit", {{"version", 1}, {"acts", Json::array({{{"act", "remove"}, {"path", "start"}}})}}), "");
  EXPECT_EQ(judged("edit", {{"version", 1}, {"acts", Json::array()}}), "");
}

TEST(Methods, NameTheErrorInAParameter) {
  EXPECT_EQ(judged("hello", Json::array()), "params: the parameters of 'hello' must be an object");
  EXPECT_EQ(judged("hello", {{"x", 1}}), "x: 'hello' has no parameter 'x'");
  EXPECT_EQ(judged("get", {{"variable", {"q"}}}), "variable: 'get' has no parameter 'variable' (variables)");
  EXPECT_EQ(judged("why", Json::object()), "variable: 'why' needs 'variable'");
  EXPECT_EQ(judged("why", {{"variable", 1}}), "variable: 'variable' must be a text");
  EXPECT_EQ(judged("get", {{"variables", {"q", 1}}}), "variables: 'variables' must be an array of texts");
  EXPECT_EQ(judged("flag", {{"up", 1}}), "up: 'up' must be true or false");
  EXPECT_EQ(judged("ring", Json::object()), "tasks: 'ring' needs 'tasks'");
  EXPECT_EQ(judged("set", {{"values", Json::array()}}), "values: 'values' must be an object");
  for (const Json& acts : {Json::object(), Json::array({1}), Json::array({Json::object(), nullptr}), Json("[]")})
    EXPECT_EQ(judged("edit", {{"version", 1}, {"acts", acts}}), "acts: 'acts' must be an array of objects");
  EXPECT_EQ(judged("write", Json::object()), "version: 'write' needs 'version'");
  EXPECT_EQ(judged("write", {{"version", 0}}), "version: 'version' must be at least 1");
  EXPECT_EQ(judged("keep", {{"what", "both"}}), "what: 'what' must be draft or file");
  EXPECT_EQ(judged("events", {{"since", -1}}), "since: 'since' must be a whole number from 0 on");
  EXPECT_EQ(judged("events", {{"since", 1.5}}), "since: 'since' must be a whole number from 0 on");
  EXPECT_EQ(judged("events", {{"since", UINT64_MAX}}), "since: 'since' must be at most 9223372036854775807");
  EXPECT_EQ(judged("events", {{"limit", 1001}}), "limit: 'limit' must be from 1 to 1000");
  EXPECT_EQ(judged("subscribe", {{"to", "status"}, {"period_ms", 19}}),
            "period_ms: 'period_ms' must be from 20 to 60000");
  EXPECT_EQ(judged("subscribe", {{"to", "valeus"}}),
            "to: 'to' must be status, events, values, tap, machines or draft (values)");
  EXPECT_EQ(judged("signal", {{"signal", "spwan"}, {"tasks", {"a"}}}),
            "signal: 'signal' must be spawn, on, off, kill, clear or reinit (spawn)");
}

TEST(Methods, ReadParametersThatMayBeLeftOut) {
  const Json parameters{{"variables", {"q", "qd"}}, {"since", 7}};
  EXPECT_EQ(texts(parameters, "variables"), (std::vector<std::string>{"q", "qd"}));
  EXPECT_TRUE(texts(parameters, "tasks").empty());
  EXPECT_EQ(number(parameters, "since", 1), 7u);
  EXPECT_EQ(number(parameters, "limit", 1000), 1000u);
}

TEST(Methods, QuoteNoMoreThanAMessageNeeds) {
  EXPECT_LT(judged("hello", {{std::string(100'000, 'x'), 1}}).size(), 200u);
}

TEST(Methods, ActsNeedTheRoleOperateOrMore) {
  std::string acts;
  for (const MethodRule& rule : methods()) {
    EXPECT_EQ(find_method(rule.name), &rule);
    EXPECT_EQ(rule.is_act, rule.role > Role::kObserve) << rule.name;
    acts += rule.is_act ? std::string(" ") + rule.name : "";
    EXPECT_EQ(static_cast<std::ptrdiff_t>(rule.id), &rule - methods().data()) << rule.name << ": keys of a table";
  }
  EXPECT_EQ(acts, " signal ring set flag switch cancel drill save end edit replace write keep start try scope halt");
  EXPECT_EQ(find_method("nothing"), nullptr);
}

}  // namespace
}  // namespace chimera::control
