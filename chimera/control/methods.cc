// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/methods.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "chimera/config/nearest.h"

namespace chimera::control {
namespace {

using Kind = ParameterKind;

constexpr MethodRule kMethods[] = {
    {"hello", Role::kObserve, false, {}},
    {"status", Role::kObserve, false, {}},
    {"describe", Role::kObserve, false, {}},
    {"get", Role::kObserve, false, {{"variables", Kind::kTexts, false}}},
    {"profile", Role::kObserve, false, {}},
    {"events", Role::kObserve, false, {{"since", Kind::kCount, false}, {"limit", Kind::kCount, false}}},
    {"why", Role::kObserve, false, {{"variable", Kind::kText, true}}},
    {"subscribe", Role::kObserve, false,
     {{"to", Kind::kText, true}, {"period_ms", Kind::kCount, false}, {"variables", Kind::kTexts, false},
      {"since", Kind::kCount, false}}},
    {"unsubscribe", Role::kObserve, false, {{"subscription", Kind::kCount, true}}},
    {"check", Role::kObserve, true, {{"text", Kind::kText, true}, {"file", Kind::kText, false}}},
    {"library", Role::kObserve, false, {}},
    {"signal", Role::kOperate, true, {{"signal", Kind::kText, true}, {"tasks", Kind::kTexts, true}}},
    {"set", Role::kOperate, true, {{"values", Kind::kObject, true}}},
    {"flag", Role::kOperate, true, {{"up", Kind::kBool, true}}},
    {"save", Role::kConfigure, true, {}},
    {"end", Role::kConfigure, true, {{"code", Kind::kCount, false}}},
};

bool is_texts(const Json& value) {
  return value.is_array() && std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_string(); });
}

bool fits(Kind kind, const Json& value) {
  switch (kind) {
    case Kind::kText: return value.is_string();
    case Kind::kTexts: return is_texts(value);
    case Kind::kBool:
      return value.is_boolean();
    case Kind::kCount:
      return value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
    case Kind::kObject:
      return value.is_object();
  }
  return false;
}

const char* words(Kind kind) {
  constexpr const char* kWords[] = {"a text", "an array of texts", "true or false", "a whole number from 0 on",
                                    "an object"};
  return kWords[static_cast<unsigned>(kind)];
}

std::string in_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

Answer bad(std::string message, const std::string& where, const std::string& nearest = {}) {
  Json data{{"where", where}};
  if (!nearest.empty()) data["nearest"] = nearest;
  return Answer::error(kBadParameters, std::move(message), data);
}

}  // namespace

std::span<const MethodRule> methods() noexcept { return kMethods; }

const MethodRule* find_method(std::string_view name) noexcept {
  for (const MethodRule& rule : kMethods)
    if (name == rule.name) return &rule;
  return nullptr;
}

Answer check_parameters(const MethodRule& rule, const Json& parameters) {
  if (!parameters.is_object()) return bad("the parameters of " + in_quotes(rule.name) + " must be an object", "params");
  std::vector<std::string> names;
  for (const Parameter& parameter : rule.parameters)
    if (parameter.name != nullptr) names.emplace_back(parameter.name);
  for (const auto& [key, value] : parameters.items())
    if (std::find(names.begin(), names.end(), key) == names.end())
      return bad(in_quotes(rule.name) + " has no parameter " + in_quotes(key), key, nearest(key, names));
  for (const Parameter& parameter : rule.parameters) {
    if (parameter.name == nullptr) break;
    const auto found = parameters.find(parameter.name);
    if (found == parameters.end()) {
      if (parameter.is_required)
        return bad(in_quotes(rule.name) + " needs " + in_quotes(parameter.name), parameter.name);
    } else if (!fits(parameter.kind, *found)) {
      return bad(in_quotes(parameter.name) + " must be " + words(parameter.kind), parameter.name);
    }
  }
  return {};
}

}  // namespace chimera::control
