// SPDX-License-Identifier: Apache-2.0
// Makes edits for a fault from the outline, and keeps those that help.
#include "chimera/verify/offers.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/key_paths.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/verify/converter.h"

namespace chimera {
namespace {

constexpr std::size_t kMostLinks = 4;  // variables offered for one input

/// Rules of a key that the description is legal without.
const std::set<std::string_view> kRemovable = {
    "unused",       "key-unknown",  "server-key",        "server-periodic",  "safe-after",
    "standby-hot",  "standby-stale", "operator-produced", "constant-produced", "configuration-task-twice",
    "configuration-empty"};
/// Rules that find a wrong key; others with a nearest name find a wrong value.
const std::set<std::string_view> kWrongKey = {"key-unknown", "port-unknown", "value-field"};

/// Rules of a port that does not fit its variable.
const std::set<std::string_view> kClashes = {"type-clash", "struct-clash", "unit-clash", "shape-clash"};

/// The edits that may remedy a fault, the likeliest first.
class Candidates {
 public:
  Candidates(const ReadDescription& reading, const Library& library, const Outline& outline)
      : draft_(*reading.draft), library_(library), outline_(outline) {}

  std::vector<Offer> of(const Fault& fault) const {
    const auto task = std::ranges::find(outline_.tasks, fault.task, &OutlineTask::name);
    if (task != outline_.tasks.end()) {
      const auto port = std::ranges::find(task->ports, fault.port, &OutlinePort::name);
      if (port != task->ports.end()) return at_port(fault, *task, *port);
      if (fault.rule == "rate-missing")
        return {{"rate: 100 Hz", {SetValue{{"tasks", task->name, "rate"}, "100 Hz"}}}};
    }
    return at_key(fault);
  }

 private:
  std::vector<Offer> at_port(const Fault& fault, const OutlineTask& task, const OutlinePort& port) const {
    if (fault.rule == "input-unmet") return links(fault, task, port);
    if (fault.rule == "two-producers") return joins(fault, port);
    if (kClashes.contains(fault.rule)) return ways_round(fault, task, port);
    if (fault.rule == "resource-missing")  // its name stands for the device, which no rule knows
      return {{"resources: {" + port.declared + ": " + port.declared + "}, to be changed",
               {SetValue{{"tasks", task.name, "resources", port.declared}, port.declared}}}};
    if (fault.rule == "loop-without-initial") {
      const std::string zero = zero_of(port);
      if (zero.empty()) return {};
      return {{"initial: {" + port.declared + ": " + zero + "}",
               {SetValue{{"tasks", task.name, "initial", port.declared}, zero}}}};
    }
    return at_key(fault);
  }

  std::vector<Offer> at_key(const Fault& fault) const {
    EditPath path = edit_path(fault.path);
    if (fault.path.empty()) return {};
    if (!fault.nearest.empty()) {
      if (kWrongKey.contains(fault.rule))
        return {{"rename to '" + fault.nearest + "'", {RenameKey{path, fault.nearest, {}}}}};
      if (fault.rule == "component-unknown" && path.size() == 2) path.push_back("component");
      return {{"write '" + fault.nearest + "'", {SetValue{path, fault.nearest}}}};
    }
    if (!kRemovable.contains(fault.rule)) return {};
    if (fault.rule == "server-periodic") path.resize(3);
    return {{"take it out", {RemoveValue{path}}}};
  }

  /// A value of zero for a port; empty: its type has none.
  static std::string zero_of(const OutlinePort& port) {
    if (port.type == "bool") return "false";
    if (port.type == "string" || port.type.starts_with("string[")) return "\"\"";
    const bool is_number = port.type.starts_with("int") || port.type.starts_with("float");
    if (!port.is_solved && !is_number) return {};
    return !is_number ? "" : port.unit == "1" ? "0" : "0 " + port.unit;
  }

  bool is_like(const OutlinePort& port, const OutlineVariable& variable) const {
    if (port.type != variable.type && port.is_solved) return false;
    const auto mine = library_.units().parse(port.unit), theirs = library_.units().parse(variable.unit);
    return !mine || !theirs || same(*mine, *theirs);
  }

  static LinkPort link(const OutlineTask& task, const OutlinePort& port, const std::string& variable) {
    LinkPort act{task.name, port.declared, variable, std::nullopt};
    if (port.name != port.declared) act.instance = std::stoul(port.name.substr(port.declared.size() + 1));
    return act;
  }

  /// A producer for an input without one.
  std::vector<Offer> links(const Fault& fault, const OutlineTask& task, const OutlinePort& port) const {
    std::vector<Offer> offers = additions(fault, port);
    add_links(offers, fault, task, port);
    if (const std::string zero = zero_of(port); !zero.empty())
      offers.push_back({"give '" + port.variable + "' under operator", {SetValue{{"operator", port.variable}, zero}}});
    return offers;
  }

  /// Another variable for an input, or a component between it and its own.
  std::vector<Offer> ways_round(const Fault& fault, const OutlineTask& task, const OutlinePort& port) const {
    if (port.kind != CHIMERA_IN_VAR) return {};
    std::vector<Offer> offers;
    if (fault.rule == "unit-clash") offers = conversions(task, port);
    add_links(offers, fault, task, port);
    return offers;
  }

  void add_links(std::vector<Offer>& offers, const Fault& fault, const OutlineTask& task,
                 const OutlinePort& port) const {
    std::vector<const OutlineVariable*> all;
    for (const OutlineVariable& variable : outline_.variables) {
      const bool is_made = !variable.producers.empty() || variable.origin == Origin::kOperator;
      if (!variable.is_constant && is_made && variable.name != port.variable && is_like(port, variable))
        all.push_back(&variable);
    }
    std::ranges::stable_sort(all, {}, [&](const OutlineVariable* v) { return v->name != fault.nearest; });
    if (all.size() > kMostLinks) all.resize(kMostLinks);
    for (const OutlineVariable* variable : all)
      offers.push_back({"link to '" + variable->name + "'", {link(task, port, variable->name)}});
  }

  /// The producers of other configurations.
  std::vector<Offer> additions(const Fault& fault, const OutlinePort& port) const {
    const auto variable = std::ranges::find(outline_.variables, port.variable, &OutlineVariable::name);
    std::vector<Offer> offers;
    if (variable == outline_.variables.end()) return offers;
    for (const PortRef ref : variable->producers) {
      const std::string& producer = outline_.tasks[ref.task].name;
      for (const DraftSet& set : draft_.configurations)
        if (set.name.text == fault.set && !set.tasks.empty())
          offers.push_back({"add '" + producer + "' to '" + fault.set + "'", {member(set, producer)}});
    }
    return offers;
  }

  std::vector<Offer> joins(const Fault& fault, const OutlinePort& port) const {
    const auto set = std::ranges::find(outline_.configurations, fault.set, &OutlineSet::name);
    const auto variable = std::ranges::find(outline_.variables, port.variable, &OutlineVariable::name);
    if (set == outline_.configurations.end() || variable == outline_.variables.end()) return {};
    const auto is_on = [&](const std::string& name) { return std::ranges::find(set->tasks, name) != set->tasks.end(); };
    JoinProducers act{variable->name, JoinBy::kMean, {}};
    for (const PortRef ref : variable->producers) {
      const OutlineTask& task = outline_.tasks[ref.task];
      if (is_on(task.name) || is_on(task.standby_for)) act.producers.push_back({task.name, task.ports[ref.port].name});
    }
    std::vector<Offer> offers;
    for (const auto& [by, label] : {std::pair{JoinBy::kMean, "join by mean"},
                                    std::pair{JoinBy::kPriority, "join by priority"},
                                    std::pair{JoinBy::kSelect, "join by selection"}}) {
      act.by = by;
      offers.push_back({label, {act}});
    }
    return offers;
  }

  /// A component between the variable and its reader.
  std::vector<Offer> conversions(const OutlineTask& task, const OutlinePort& port) const {
    const auto variable = std::ranges::find(outline_.variables, port.variable, &OutlineVariable::name);
    if (variable == outline_.variables.end()) return {};
    const auto from = library_.units().parse(variable->unit), to = library_.units().parse(port.unit);
    if (!from || !to) return {};
    const auto made = converter_of(library_, {*from, variable->unit}, {*to, port.unit});
    if (!made) return {};
    const std::string name = free_name(names_of(outline_.tasks, &OutlineTask::name), made->component);
    const std::string out = free_name(names_of(outline_.variables, &OutlineVariable::name), variable->name);
    Offer offer{"insert '" + made->component + "'", {AddTask{name, made->component}}};
    if (task.rate_hz > 0) offer.acts.push_back(SetValue{{"tasks", name, "rate"}, formatted("%.10g Hz", task.rate_hz)});
    if (!made->factor.empty()) offer.acts.push_back(SetValue{{"tasks", name, "constants", "factor"}, made->factor});
    offer.acts.push_back(LinkPort{name, made->in, variable->name, std::nullopt});
    offer.acts.push_back(LinkPort{name, made->out, out, std::nullopt});
    offer.acts.push_back(link(task, port, out));
    add_to_configurations(offer, task.name, name);
    return {offer};
  }

  void add_to_configurations(Offer& offer, const std::string& with, const std::string& name) const {
    for (const DraftSet& set : draft_.configurations)
      if (std::ranges::find(set.tasks, with, &Word::text) != set.tasks.end()) offer.acts.push_back(member(set, name));
  }

  /// Appends a task to a configuration.
  SetValue member(const DraftSet& set, const std::string& name) const {
    EditPath path = draft_.keys->names(set.tasks.back().at.key);
    path.back() = std::to_string(set.tasks.size());
    return {path, name};
  }

  static std::string free_name(const std::vector<std::string>& used, const std::string& stem) {
    std::string name = stem;
    for (int n = 2; std::ranges::find(used, name) != used.end(); ++n) name = stem + '_' + std::to_string(n);
    return name;
  }

  const Draft& draft_;
  const Library& library_;
  const Outline& outline_;
};

/// The words of a fault without the places in its message, which an edit moves.
std::string identity(const Fault& fault) {
  std::string words(fault.rule);
  for (const std::string* part : {&fault.set, &fault.task, &fault.port, &fault.message}) words += '\n' + *part;
  for (std::size_t at = words.find(" at "); at != std::string::npos; at = words.find(" at ", at + 1))
    words.erase(at + 4, std::min(words.find_first_not_of("0123456789:", at + 4), words.size()) - at - 4);
  return words;
}

struct Counted {
  std::map<std::string, int> errors, warnings;

  explicit Counted(const Report& report) {
    for (const Fault& fault : report.faults()) ++of(fault.severity)[identity(fault)];
  }
  std::map<std::string, int>& of(Severity severity) { return severity == Severity::kError ? errors : warnings; }
};

/// True if `after` is better than `before` by `fault`, and has no error of its own.
bool helps(const Fault& fault, const Report& before, const Report& after) {
  Counted old(before), now(after);
  if (now.of(fault.severity)[identity(fault)] >= old.of(fault.severity)[identity(fault)]) return false;
  for (const auto& [words, times] : now.errors)
    if (times > old.errors[words]) return false;
  return fault.severity == Severity::kError ? after.errors() < before.errors() : after.warnings() < before.warnings();
}

}  // namespace

void offer_edits(const ReadDescription& reading, const Library& library, Outlined& outlined, std::size_t most_tries) {
  if (!outlined.outline) return;
  const Report before = outlined.verdict.report;
  const Candidates candidates(reading, library, *outlined.outline);
  std::vector<std::vector<Offer>> of_fault;
  std::size_t most = 0;
  for (const Fault& fault : before.faults()) most = std::max(most, of_fault.emplace_back(candidates.of(fault)).size());
  std::size_t tries = 0;
  for (std::size_t rank = 0; rank < most; ++rank)
    for (std::size_t f = 0; f < of_fault.size(); ++f) {
      if (rank >= of_fault[f].size()) continue;
      if (++tries > most_tries) return;
      Offer& offer = of_fault[f][rank];
      const auto text = edit_text(reading.text, offer.acts);
      if (!text) continue;
      if (helps(before.faults()[f], before, verify(read_description(*text, before.file()), library).report))
        outlined.verdict.report.offer(f, std::move(offer));
    }
}

}  // namespace chimera
