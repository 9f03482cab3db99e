// SPDX-License-Identifier: Apache-2.0
// The data of the legality rules: the draft, linked with descriptors, with results added step by step. Lives only
// inside verify(); pointers into draft and library are valid during that call.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/description/draft.h"
#include "chimera/description/report.h"
#include "chimera/load/descriptor.h"
#include "chimera/units/unit.h"
#include "chimera/units/unit_expression.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera {

/// A dimension of a port of a task: a literal (`constant` empty) or a constant variable with a maximum. `known` is the
/// number of elements if the description or a default settles it.
struct SolvedExtent {
  std::string constant;
  std::uint32_t max = 1;
  std::optional<std::uint32_t> known;
};

/// True for a port that may be left out: a repeated in-var of at most one instance. `on` alone reads it.
inline bool may_be_left_out(const PortDescriptor& port) noexcept {
  return port.kind == CHIMERA_IN_VAR && port.repeated && port.max_instances == 1;
}

/// The source of the value of an in-const.
enum class ConstSource : std::uint8_t { kNobody, kOwn, kVariable, kDefault };

/// An instance of a port of a task.
struct LinkedPort {
  const PortDescriptor* declared = nullptr;
  std::uint32_t index = 0;  ///< of `declared` in the component
  std::uint32_t instance = 0;
  std::size_t task = 0;
  std::string name;                           ///< "x", "in[2]"
  std::string variable;                       ///< "" for resources and in-consts that are not linked
  std::string parted_from;                    ///< `variable` before a fault parted the port from it
  Place at;                                   ///< of the alias, otherwise of the task
  const Node* own = nullptr;                  ///< `constants`, `initial` or `resources` of the task
  bool is_own_item = false;                   ///< `own` is an item of a written list
  ConstSource source = ConstSource::kNobody;  ///< in-const
  // Set by the rules of agreement:
  std::optional<std::uint32_t> type;
  std::uint32_t element_bytes = 0;
  std::optional<Unit> unit;
  std::string unit_text;
  std::vector<std::size_t> unit_by;  ///< numbers of the written values that settled the unit (rule_units.cc)
  std::vector<SolvedExtent> extents;
  bool has_extents = false;
  /// Written, default or initial value, elements at their maxima; empty: none, or only init knows it.
  std::vector<std::byte> value;
  std::vector<std::byte> max_step;  ///< out-var: form of `value`; empty: none

  bool is(std::uint32_t kind) const noexcept { return declared->kind == kind; }
  bool is_linked() const noexcept { return !variable.empty(); }
  bool is_producer() const noexcept { return is(CHIMERA_OUT_VAR) || is(CHIMERA_OUT_CONST); }
};

struct TaskModel {
  const DraftTask* draft = nullptr;
  const Descriptor* component = nullptr;  ///< nullptr: unknown
  std::vector<LinkedPort> ports;
  std::optional<Nanoseconds> period;
  double rate_hz = 0;
  Nanoseconds deadline, offset, budget, min_time;
  std::uint32_t criticality = 0;
  std::size_t rtpu = 0;
  std::uint32_t place = 0;  ///< TaskSpec::place
  bool lacks_link = false;  ///< a name under its keys is no port, or a repeated port has no instances

  const std::string& name() const noexcept { return draft->name.text; }
  /// True for an unknown component, and for a task with a key or a link that could not be read.
  bool is_partial() const noexcept { return component == nullptr || draft->is_partial || lacks_link; }
  bool has_inputs() const noexcept;
  bool has_resource() const noexcept;
};

struct VariableModel {
  std::string name;
  bool is_constant = false;
  const NamedNode* given = nullptr;  ///< by `operator` or `constants`, or the default of an input
  bool is_default = false;           ///< `given` stands for the default of its only reader, an optional input
  std::vector<std::byte> value;      ///< the bytes of `given`, in the form of its first consumer
  std::vector<PortRef> producers, consumers;
  // The agreement of its ports, each with the port that settled it (nullopt: the given value).
  std::optional<std::uint32_t> type;
  std::optional<Unit> unit;
  std::string unit_text;
  std::vector<std::size_t> unit_by;  ///< as of LinkedPort
  std::optional<PortRef> type_from, unit_from, shape_from;
  std::vector<SolvedExtent> extents;
  bool has_extents = false;

  bool is_given() const noexcept { return given != nullptr; }
  bool is_written() const noexcept { return given != nullptr && !is_default; }
};

struct SetModel {
  std::string name;
  Place at;
  std::vector<TaskId> tasks;  ///< in the order of the description
  bool is_whole = true;            ///< false: it names an unknown task, so its inputs are not judged
  std::vector<TaskId> order;
  SafeCondition safe_when;                 ///< the variable is `safe_variable`
  std::optional<std::size_t> safe_variable;  ///< in Model::variables; nothing: no condition

  bool has(std::size_t task) const noexcept;
};

/// An input without a producer in a configuration, as the message names it.
struct UnmetInput {
  PortRef port;
  std::size_t set = 0;       ///< in Model::sets
  std::size_t variable = 0;  ///< in Model::variables
  std::string said;
};

/// A written list that gives the number of elements of a constant extent before `init` does.
struct WrittenLength {
  std::size_t count = 0;
  Place at;
};

/// The place of a fault in the text, and the part of the picture at which it stands. A place below `tasks` or
/// `configurations` gives task, port and configuration by itself (Report::add).
struct Spot {
  Place at;
  std::optional<std::size_t> task = {};
  std::string_view port = {};      ///< lives as long as the model
  const SetModel* set = nullptr;

  Spot(Place place) : at(place) {}
  Spot(Place place, std::string_view name) : at(place), port(name) {}
  Spot(Place place, const LinkedPort& of) : at(place), task(of.task), port(of.name) {}
  Spot(const LinkedPort& of) : Spot(of.at, of) {}
  Spot in(const SetModel& which) const {
    Spot spot = *this;
    spot.set = &which;
    return spot;
  }
};

struct Model {
  Model(const Draft& d, const Library& l, Report& r) : draft(d), library(l), report(r) {}

  const Draft& draft;
  const Library& library;
  Report& report;
  std::vector<TaskModel> tasks;
  std::vector<VariableModel> variables;
  std::map<std::string, std::size_t, std::less<>> variable_index;
  std::vector<SetModel> sets;
  std::size_t start = 0;
  std::vector<StandbySpec> standbys;  ///< in the order of the tasks; the primary may break a rule on standbys
  std::vector<DraftRtpu> rtpus;  ///< the declared ones, or the default one
  std::vector<TaskId> init_order;
  std::map<std::string, WrittenLength> written_lengths;  ///< by constant
  Overload overload = Overload::kRefused;
  std::vector<UnmetInput> unmet;
  std::deque<NamedNode> defaults;  ///< VariableModel::given of optional inputs; elements never move
  bool has_unmet = false;  ///< links are missing, or left out because their types clash

  LinkedPort& port(PortRef ref) { return tasks[ref.task].ports[ref.port]; }
  const LinkedPort& port(PortRef ref) const { return tasks[ref.task].ports[ref.port]; }
  std::optional<std::size_t> task_named(std::string_view name) const;
  /// The primary of `standby`; nothing if it has none or names an unknown task.
  std::optional<std::size_t> primary_of(std::size_t standby) const;
  /// The key `sequence` that made the task; nullptr: the text has the task itself.
  const DraftSequence* sequence_of(std::size_t task) const noexcept {
    const bool is_its = draft.sequence && draft.tasks[task].name.at == draft.sequence->at;
    return is_its ? &*draft.sequence : nullptr;
  }
  VariableModel* variable(std::string_view name);
  /// The variable of the port; nullptr: not linked.
  VariableModel* variable(const LinkedPort& p) { return p.is_linked() ? variable(p.variable) : nullptr; }
  /// Clears the variable of a port, which remembers it.
  static void part(LinkedPort& of) { of.parted_from = std::exchange(of.variable, {}); }
  /// Takes the port out of its variable, so that a wrong link carries no type, unit or shape to other ports.
  void unlink(PortRef ref);
  /// True if a missing part could explain other missing parts: then report no missing parts.
  bool is_incomplete() const noexcept;

  void error(std::string_view rule, const Spot& spot, std::string message, std::string found = {},
             std::string expected = {}, std::string nearest = {}, std::string remedy = {});
  void warn(std::string_view rule, const Spot& spot, std::string message, std::string remedy = {});
  void add(const Spot& spot, Fault fault);

  /// "output 'tau' of task 'pid'", with "(variable 'x')" if an alias gives it.
  std::string say(const LinkedPort& port) const;
  /// "12:8".
  static std::string say(Place at) { return std::to_string(at.line) + ':' + std::to_string(at.column); }
};

// ---- what the three rules of agreement (types, units, shapes) share: the bindings of the symbols of a task ----

/// A variable of a generic component: the task, and its symbol. If only repeated ports use a symbol, each number of an
/// instance has its own: a logger can read signals of different kinds, and each register has its own scale.
using SymbolKey = std::pair<std::size_t, std::string>;

/// `uses(port, symbol)` returns if a declared port contains the symbol. Context: setup.
template <class Uses>
SymbolKey symbol_key(const TaskModel& task, const LinkedPort& port, const std::string& symbol, Uses uses) {
  const bool apart = std::ranges::none_of(task.component->ports, [&](const PortDescriptor& declared) {
    return uses(declared, symbol) && !declared.repeated;
  });
  return {port.task, apart ? symbol + '#' + std::to_string(port.instance) : symbol};
}

/// The solution of a symbol, and the port that gave it.
template <class T>
struct Binding {
  T value;
  PortRef from;
};

template <class T>
using Bindings = std::map<SymbolKey, Binding<T>>;

/// Calls `act` for every port with a place in the table or with a value: all but resources and streams.
template <class Do>
void for_each_port(Model& model, Do act) {
  for (std::size_t t = 0; t < model.tasks.size(); ++t)
    for (std::size_t p = 0; p < model.tasks[t].ports.size(); ++p)
      if (model.tasks[t].ports[p].declared->kind <= CHIMERA_OUT_CONST) act(PortRef{t, p}, model.tasks[t].ports[p]);
}

/// Calls `act` for producers, then consumers: the first concrete one settles the variable.
template <class Do>
void for_each_port_of(const VariableModel& variable, Do act) {
  for (const PortRef ref : variable.producers) act(ref);
  for (const PortRef ref : variable.consumers) act(ref);
}

/// "float64", "string[16]", "Pose". Requires: the type of the port is solved. Context: setup.
std::string type_text(const LinkedPort& port);

/// The source that settled a variable: "output 'q' of task 'arm' at 7:3", or the given value.
std::string settled_by(const Model& model, const VariableModel& variable, const std::optional<PortRef>& from);

}  // namespace chimera
