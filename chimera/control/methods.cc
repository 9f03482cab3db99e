// SPDX-License-Identifier: Apache-2.0
// The table of methods; judges the parameters of a call by its row, and reads them.
#include "chimera/control/methods.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "chimera/base/hosted/wording.h"
#include "chimera/task/signal.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"

namespace chimera::control {
namespace {

using Kind = ParameterKind;

constexpr Parameter count(const char* name, std::uint64_t least, std::uint64_t most, bool is_required = false) {
  return {name, Kind::kCount, is_required, nullptr, least, most};
}

constexpr MethodRule question(MethodId id, const char* name) { return {id, name, Role::kObserve, false, false, {}}; }

constexpr Parameter kTasks = {"tasks", Kind::kTexts, true};
constexpr Parameter kText = {"text", Kind::kText, true}, kFile = {"file", Kind::kText, false};
constexpr Parameter kComponent = {"component", Kind::kText, true};
constexpr Parameter kNumber = count("number", 1, INT64_MAX, true);
constexpr Parameter kVersion = count("version", 1, INT64_MAX, true);

/// The signals that a client may name, a blank between each two: all before `wakeup`, which is `ring`.
constexpr auto kSignals = [] {
  std::array<char, 64> words{};
  std::size_t end = 0;
  for (std::uint32_t signal = 0; signal < static_cast<std::uint32_t>(Signal::kWakeup); ++signal) {
    if (end > 0) words[end++] = ' ';
    for (const char* c = signal_name(static_cast<Signal>(signal)); *c != '\0'; ++c) words[end++] = *c;
  }
  return words;
}();

// clang-format off
constexpr MethodRule kMethods[] = {
    question(MethodId::kHello, "hello"),
    question(MethodId::kStatus, "status"),
    {MethodId::kDescribe, "describe", Role::kObserve, false, false,
     {{"picture", Kind::kBool, false}, {"configuration", Kind::kText, false}}},
    {MethodId::kGet, "get", Role::kObserve, false, false, {{"variables", Kind::kTexts, false}}},
    question(MethodId::kProfile, "profile"),
    {MethodId::kEvents, "events", Role::kObserve, false, false,
     {count("since", 0, INT64_MAX), count("limit", 1, 1000)}},
    {MethodId::kReceipts, "receipts", Role::kObserve, false, false, {count("last", 1, 200)}},
    {MethodId::kWhy, "why", Role::kObserve, false, false, {{"variable", Kind::kText, true}}},
    {MethodId::kPlan, "plan", Role::kObserve, false, false,
     {{"configuration", Kind::kText, false}, {"on", Kind::kTexts, false}, {"off", Kind::kTexts, false}}},
    {MethodId::kSubscribe, "subscribe", Role::kObserve, false, false,
     {{"to", Kind::kText, true, "status events values tap machines draft"}, count("period_ms", 20, 60'000),
      {"variables", Kind::kTexts, false}, count("since", 0, INT64_MAX)}},
    {MethodId::kUnsubscribe, "unsubscribe", Role::kObserve, false, false, {count("subscription", 1, INT64_MAX, true)}},
    {MethodId::kCheck, "check", Role::kObserve, false, true, {kText, kFile}},
    {MethodId::kSchedule, "schedule", Role::kObserve, false, true, {kText, kFile}},
    question(MethodId::kLibrary, "library"),
    question(MethodId::kText, "text"),
    {MethodId::kSignal, "signal", Role::kOperate, true, false,
     {{"signal", Kind::kText, true, kSignals.data()}, kTasks}},
    {MethodId::kRing, "ring", Role::kOperate, true, false, {kTasks}},
    {MethodId::kSet, "set", Role::kOperate, true, false, {{"values", Kind::kObject, true}}},
    {MethodId::kFlag, "flag", Role::kOperate, true, false, {{"up", Kind::kBool, true}}},
    {MethodId::kSwitch, "switch", Role::kOperate, true, false,
     {{"configuration", Kind::kText, false}, count("wait_ms", 1, 600'000), {"on", Kind::kTexts, false},
      {"off", Kind::kTexts, false}}},
    {MethodId::kCancel, "cancel", Role::kOperate, true, false, {}},
    {MethodId::kDrill, "drill", Role::kConfigure, true, false,
     {count("wait_ms", 1, 600'000), {"kill", Kind::kText, false}}},
    {MethodId::kSave, "save", Role::kConfigure, true, false, {}},
    {MethodId::kEnd, "end", Role::kConfigure, true, false, {count("code", 0, 255)}},
    question(MethodId::kMachines, "machines"),
    {MethodId::kDraft, "draft", Role::kObserve, false, true, {}},
    {MethodId::kEdit, "edit", Role::kConfigure, true, false, {kVersion, {"acts", Kind::kObjects, true}}},
    {MethodId::kReplace, "replace", Role::kConfigure, true, false, {kVersion, kText}},
    {MethodId::kRemedies, "remedies", Role::kObserve, false, true, {kVersion}},
    {MethodId::kTransitions, "transitions", Role::kObserve, false, true, {kVersion}},
    {MethodId::kDifferences, "differences", Role::kObserve, false, true, {{"text", Kind::kText, false}}},
    {MethodId::kWrite, "write", Role::kConfigure, true, false, {kVersion}},
    {MethodId::kKeep, "keep", Role::kConfigure, true, false, {{"what", Kind::kText, true, "draft file"}}},
    {MethodId::kStart, "start", Role::kConfigure, true, false, {}},
    question(MethodId::kOutput, "output"),
    {MethodId::kSheet, "sheet", Role::kObserve, false, true, {kComponent}},
    {MethodId::kDocument, "document", Role::kObserve, false, false, {{"name", Kind::kText, true}}},
    {MethodId::kValues, "values", Role::kObserve, false, false, {kComponent, {"port", Kind::kText, true}}},
    {MethodId::kTry, "try", Role::kConfigure, true, false,
     {kVersion, {"duration", Kind::kText, true}, {"watch", Kind::kTexts, true}, {"every", Kind::kText, false},
      {"at", Kind::kTexts, false}, {"expect", Kind::kTexts, false}, {"devices", Kind::kBool, false}}},
    {MethodId::kScope, "scope", Role::kConfigure, true, false,
     {{"machine", Kind::kText, true}, {"channels", Kind::kTexts, true}, {"trigger", Kind::kText, false},
      {"pre", Kind::kText, false}, {"for", Kind::kText, false}, {"wait", Kind::kText, false}}},
    {MethodId::kResult, "result", Role::kObserve, false, false, {kNumber}},
    {MethodId::kHalt, "halt", Role::kConfigure, true, false, {kNumber}},
};
// clang-format on

bool is_texts(const Json& value) {
  return value.is_array() && std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_string(); });
}

bool is_objects(const Json& value) {
  return value.is_array() && std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_object(); });
}

bool fits(Kind kind, const Json& value) {
  switch (kind) {
    case Kind::kText: return value.is_string();
    case Kind::kTexts: return is_texts(value);
    case Kind::kBool:
      return value.is_bool();
    case Kind::kCount:
      return value.is_whole() && value.as_int64() >= 0;
    case Kind::kObject: return value.is_object();
    case Kind::kObjects: return is_objects(value);
  }
  return false;
}

const char* meaning(Kind kind) {
  constexpr const char* kWords[] = {"a text", "an array of texts", "true or false", "a whole number from 0 on",
                                    "an object", "an array of objects"};
  return kWords[static_cast<unsigned>(kind)];
}

RpcResponse bad(std::string message, const std::string& where, const std::string& nearest = {}) {
  Json data{{"where", where}};
  if (!nearest.empty()) data["nearest"] = nearest;
  return RpcResponse::error(kBadParameters, std::move(message), data);
}

/// The beginning of a text that a client sent: as much as a message needs.
std::string quotable(const std::string& text) { return text.substr(0, 40); }

std::string near_of(const std::string& wrong, const std::vector<std::string>& names) {
  return wrong.size() <= 40 ? nearest(wrong, names) : "";
}

RpcResponse check_word(const Parameter& parameter, const std::string& word) {
  std::vector<std::string> words;
  std::istringstream in(parameter.words);
  for (std::string one; in >> one;) words.push_back(one);
  if (std::find(words.begin(), words.end(), word) != words.end()) return {};
  const std::string listed = join(words, ", ", {}, " or ");
  return bad(in_quotes(parameter.name) + " must be " + listed, parameter.name, near_of(word, words));
}

RpcResponse check_count(const Parameter& parameter, std::uint64_t count) {
  if (count >= parameter.least && count <= parameter.most) return {};
  const bool has_limit = parameter.most < INT64_MAX;
  const std::string least = std::to_string(parameter.least), most = std::to_string(parameter.most);
  const std::string range = has_limit                  ? "from " + least + " to " + most
                            : count < parameter.least ? "at least " + least
                                                      : "at most " + most;
  return bad(in_quotes(parameter.name) + " must be " + range, parameter.name);
}

RpcResponse check_value(const Parameter& parameter, const Json& value) {
  if (!fits(parameter.kind, value))
    return bad(in_quotes(parameter.name) + " must be " + meaning(parameter.kind), parameter.name);
  if (parameter.words != nullptr) return check_word(parameter, value.as_string());
  return parameter.kind == Kind::kCount ? check_count(parameter, value.as_uint64()) : RpcResponse{};
}

}  // namespace

std::span<const MethodRule> methods() noexcept { return kMethods; }

const MethodRule* find_method(std::string_view name) noexcept {
  for (const MethodRule& rule : kMethods)
    if (name == rule.name) return &rule;
  return nullptr;
}

RpcResponse check_parameters(const MethodRule& rule, const Json& parameters) {
  if (!parameters.is_object()) return bad("the parameters of " + in_quotes(rule.name) + " must be an object", "params");
  std::vector<std::string> names;
  for (const Parameter& parameter : rule.parameters)
    if (parameter.name != nullptr) names.emplace_back(parameter.name);
  for (const auto& [key, value] : parameters.items())
    if (std::find(names.begin(), names.end(), key) == names.end())
      return bad(in_quotes(rule.name) + " has no parameter " + in_quotes(quotable(key)), quotable(key),
                 near_of(key, names));
  for (const Parameter& parameter : rule.parameters) {
    if (parameter.name == nullptr) break;
    const Json* found = parameters.find(parameter.name);
    if (found == nullptr) {
      if (!parameter.is_required) continue;
      return bad(in_quotes(rule.name) + " needs " + in_quotes(parameter.name), parameter.name);
    } else if (RpcResponse judged = check_value(parameter, *found); !judged.is_good()) {
      return judged;
    }
  }
  return {};
}

std::vector<std::string> texts(const Json& parameters, const char* key) {
  const Json* found = parameters.find(key);
  return found == nullptr ? std::vector<std::string>() : found->as_strings();
}

std::uint64_t number(const Json& parameters, const char* key, std::uint64_t otherwise) {
  const Json* found = parameters.find(key);
  return found == nullptr ? otherwise : found->as_uint64();
}

}  // namespace chimera::control
