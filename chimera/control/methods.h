// SPDX-License-Identifier: Apache-2.0
// The methods of the control protocol, in one table: the role that may call each, and its parameters. The parameters of
// a call are judged by the row of its method, and read after that.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/control/rpc_response.h"

namespace chimera::control {

enum class ParameterKind : unsigned char { kText, kTexts, kBool, kCount, kObject, kObjects };

struct Parameter {
  const char* name = nullptr;
  ParameterKind kind = ParameterKind::kText;
  bool is_required = false;
  const char* words = nullptr;            ///< of a text: the words it may be, a blank between each two; null: any
  std::uint64_t least = 0, most = INT64_MAX;  ///< of a count
};

/// Number of the function that carries a method out: the key of a ControlBackend's table.
enum class MethodId : unsigned char {
  kHello, kStatus, kDescribe, kGet, kProfile, kEvents, kReceipts, kWhy, kPlan, kSubscribe, kUnsubscribe, kCheck,
  kSchedule, kLibrary, kText, kSignal, kRing, kSet, kFlag, kSwitch, kCancel, kDrill, kSave, kEnd,
  kMachines, kDraft, kEdit, kReplace, kRemedies, kTransitions, kDifferences, kWrite, kKeep, kStart, kOutput, kSheet,
  kDocument, kValues, kTry, kScope, kResult, kHalt
};

struct MethodRule {
  MethodId id = MethodId::kHello;
  const char* name = nullptr;
  Role role = Role::kObserve;
  bool is_act = false;     ///< an act of the document: goes before questions, and a client never sends it twice
  bool is_costly = false;  ///< a question that takes long: counts as an act in the rate of its connection
  Parameter parameters[7];
};

/// Every method once, in the order of MethodId.
std::span<const MethodRule> methods() noexcept;
/// True for the methods of chimera-web, which a subsystem refuses.
constexpr bool is_of_bench(MethodId id) noexcept { return id >= MethodId::kMachines; }
/// The rule of that name; nullptr: there is none.
const MethodRule* find_method(std::string_view name) noexcept;
/// Judges the parameters of a call: an error, or an answer without result when they are as the rule says.
RpcResponse check_parameters(const MethodRule& rule, const Json& parameters);
/// The texts under `key` of parameters that are as their rule says; none when `key` is not there. Context: setup.
std::vector<std::string> texts(const Json& parameters, const char* key);
/// The count under `key` of such parameters, else `otherwise`. Context: setup.
std::uint64_t number(const Json& parameters, const char* key, std::uint64_t otherwise);

}  // namespace chimera::control
