// SPDX-License-Identifier: Apache-2.0
// Makes edits for a fault from the outline.
#include "chimera/verify/offer_candidates.h"

#include <algorithm>
#include <functional>
#include <set>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/key_paths.h"
#include "chimera/verify/converter.h"
#include "chimera/verify/offer_load.h"

namespace chimera {
namespace {

constexpr std::size_t kMostLinks = 4;  // variables or words offered for one place

/// Rules of a whole task, configuration or rtpu that the description may do without.
const std::set<std::string_view> kNeedless = {"unused", "component-unknown", "configuration-empty", "port-stream",
                                              "name-illegal"};
/// Rules that find a wrong key; others with a nearest name find a wrong value.
const std::set<std::string_view> kWrongKey = {"key-unknown", "port-unknown", "value-field"};
/// Rules that expect one of a list of words.
const std::set<std::string_view> kWords = {"word-unknown", "rtpu-unknown", "configuration-unknown", "standby-unknown"};
/// Rules of a port that does not fit its variable, or does not get what it needs from it.
const std::set<std::string_view> kClashes = {"type-clash",           "struct-clash",       "unit-clash",
                                             "shape-clash",          "type-contradiction", "type-unsolved",
                                             "unit-unsolved",        "extent-unsolved",    "unit-contradiction",
                                             "extent-contradiction", "standby-outputs",    "constant-two-producers"};

void append(std::vector<Offer>& offers, std::vector<Offer> more) {
  std::ranges::move(more, std::back_inserter(offers));
}

/// The words of "'a', 'b'".
std::vector<std::string> quoted_words(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = text.find('\''), end = 0; at != std::string::npos; at = text.find('\'', end + 1)) {
    end = text.find('\'', at + 1);
    if (end == std::string::npos) break;
    words.push_back(text.substr(at + 1, end - at - 1));
  }
  return words;
}

class Candidates {
 public:
  Candidates(const Fault& fault, const Draft& draft, const Library& library, const Outline& outline)
      : fault_(fault), draft_(draft), library_(library), outline_(outline) {}

  std::vector<Offer> all() const {
    const auto task = std::ranges::find(outline_.tasks, fault_.task, &OutlineTask::name);
    if (task == outline_.tasks.end()) return fault_.rule == "standby-in-configuration" ? without_standby() : at_key();
    const auto port = std::ranges::find(task->ports, fault_.port, &OutlinePort::name);
    return port != task->ports.end() ? at_port(*task, *port) : at_task(*task);
  }

 private:
  std::vector<Offer> at_task(const OutlineTask& task) const {
    if (fault_.rule == "rate-missing") return {{"rate: 100 Hz", {SetValue{{"tasks", task.name, "rate"}, "100 Hz"}}}};
    if (fault_.rule == "repeated-port") return instances(task);
    if (fault_.rule == "standby-outputs") return outputs_of_primary(task);
    std::vector<Offer> offers;
    if (fault_.rule == "utilisation") offers = lighter(fault_, draft_, outline_);
    if (fault_.rule == "utilisation" || fault_.rule == "rtpu-band" || fault_.rule == "standby-same-rtpu") {
      append(offers, moves(task, outline_));
      return offers;
    }
    if (fault_.rule == "unused" && fault_.path == "tasks/" + task.name)
      for (const DraftSet& set : draft_.configurations) append(offers, addition(set, task.name));
    append(offers, at_key());
    return offers;
  }

  std::vector<Offer> at_port(const OutlineTask& task, const OutlinePort& port) const {
    if (fault_.rule == "input-unmet" || fault_.rule == "constant-unmet") return sources(task, port);
    if (fault_.rule == "two-producers") return joins(task, port);
    if (kClashes.contains(fault_.rule)) return ways_round(task, port);
    if (fault_.rule == "resource-missing")  // its name stands for the device, which no rule knows
      return {{"resources: {" + port.declared + ": " + port.declared + "}, to be changed",
               {SetValue{{"tasks", task.name, "resources", port.declared}, port.declared}}}};
    if (fault_.rule == "loop-without-initial") {
      const std::string value = value_of(task, port);
      if (value.empty()) return {};
      return {{"initial: {" + port.declared + ": " + value + "}",
               {SetValue{{"tasks", task.name, "initial", port.declared}, value}}}};
    }
    return at_key();
  }

  std::vector<Offer> at_key() const {
    EditPath path = edit_path(fault_.path);
    if (path.empty()) {
      if (fault_.rule != "key-missing" || fault_.expected != "subsystem") return {};
      return {{"subsystem: untitled", {SetValue{{"subsystem"}, "untitled"}}}};
    }
    if (!fault_.nearest.empty()) {
      if (kWrongKey.contains(fault_.rule))
        return {{"rename to '" + fault_.nearest + "'", {RenameKey{path, fault_.nearest, {}}}}};
      if (fault_.rule == "component-unknown" && path.size() == 2) path.push_back("component");
      return {written(path, fault_.nearest)};
    }
    std::vector<Offer> offers;
    for (const std::string& word : words())
      if (offers.size() < kMostLinks) offers.push_back(written(path, word));
    if (fault_.rule == "server-periodic") path.resize(3);
    if (may_go(path)) offers.push_back({"take it out", {RemoveValue{path}}});
    return offers;
  }

  static Offer written(const EditPath& path, const std::string& word) {
    return {"write '" + word + "'", {SetValue{path, word}}};
  }

  /// Other texts for the value at the place.
  std::vector<std::string> words() const {
    if (kWords.contains(fault_.rule)) return quoted_words(fault_.expected);
    if (fault_.found.empty() || fault_.found.find_first_not_of("+-.0123456789e") != std::string::npos) return {};
    if (fault_.rule == "value-unit") return {fault_.found + ' ' + fault_.expected};
    if (fault_.rule != "quantity-bad") return {};
    if (fault_.expected == "a frequency") return {fault_.found + " Hz"};
    return {fault_.found + " us", fault_.found + " ms"};
  }

  /// True if the key at `path` may be needless. An item of a value is not: the others would get its place.
  bool may_go(const EditPath& path) const {
    const std::string& top = path[0];
    const bool is_item = path.back().find_first_not_of("0123456789") == std::string::npos;
    if (path.size() == 2 && (top == "tasks" || top == "configurations" || top == "rtpus"))
      return kNeedless.contains(fault_.rule);
    return !is_item || top == "configurations";
  }

  const PortDescriptor* declared(const OutlineTask& task, const std::string& port) const {
    const LibraryEntry* entry = library_.find(task.component);
    return entry != nullptr ? entry->descriptor.port(port) : nullptr;
  }

  /// The legal value of a port that is nearest to zero, or its first legal word; empty: its type has none.
  std::string value_of(const OutlineTask& task, const OutlinePort& port) const {
    const PortDescriptor* one = declared(task, port.declared);
    if (port.type == "bool") return "false";
    if (port.type == "string" || port.type.starts_with("string["))
      return one != nullptr && !one->one_of.empty() ? one->one_of[0] : "\"\"";
    if (!port.type.starts_with("int") && !port.type.starts_with("uint") && !port.type.starts_with("float")) return {};
    const double value = one != nullptr && one->has_range ? std::clamp(0.0, one->min, one->max) : 0;
    return formatted("%.10g", value) + (port.unit == "1" ? "" : ' ' + port.unit);
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

  /// A source for an input or constant without one.
  std::vector<Offer> sources(const OutlineTask& task, const OutlinePort& port) const {
    const bool is_constant = port.kind == CHIMERA_IN_CONST;
    std::vector<Offer> offers = additions(), links;
    add_links(links, task, port);
    const auto give = [&](const std::string& section, const std::string& variable) {
      if (const std::string value = value_of(task, port); !value.empty())
        offers.push_back(
            {section + ": {" + variable + ": " + value + "}, to be changed", {SetValue{{section, variable}, value}}});
    };
    if (is_constant) give("constants", fault_.found);
    append(offers, links);
    if (!is_constant) give("operator", port.variable);
    return offers;
  }

  /// Another variable for a port that does not fit its own, or a component between the two.
  std::vector<Offer> ways_round(const OutlineTask& task, const OutlinePort& port) const {
    std::vector<Offer> offers;
    if (port.kind == CHIMERA_IN_VAR || port.kind == CHIMERA_IN_CONST) {
      if (fault_.rule == "unit-clash") offers = conversions(task, port);
      add_links(offers, task, port);
      return offers;
    }
    if (fault_.rule.ends_with("unsolved")) return {};
    offers.push_back(apart(task, port));
    const auto variable = std::ranges::find(outline_.variables, port.variable, &OutlineVariable::name);
    if (variable == outline_.variables.end()) return offers;
    for (const PortRef ref : variable->consumers) {
      const OutlineTask& reader = outline_.tasks[ref.task];
      append(offers, conversions(reader, reader.ports[ref.port]));
      add_links(offers, reader, reader.ports[ref.port]);
    }
    return offers;
  }

  /// A variable of its own for an output.
  Offer apart(const OutlineTask& task, const OutlinePort& port) const {
    const std::string name = free_name(names_of(outline_.variables, &OutlineVariable::name), port.variable);
    return {"link '" + port.name + "' of '" + task.name + "' to a new variable '" + name + "'",
            {link(task, port, name)}};
  }

  void add_links(std::vector<Offer>& offers, const OutlineTask& task, const OutlinePort& port) const {
    std::vector<const OutlineVariable*> all;
    for (const OutlineVariable& variable : outline_.variables) {
      const bool is_made =
          !variable.producers.empty() || variable.origin == Origin::kOperator || variable.origin == Origin::kConstants;
      const bool is_kind = variable.is_constant == (port.kind == CHIMERA_IN_CONST);
      if (is_kind && is_made && variable.name != port.variable && is_like(port, variable)) all.push_back(&variable);
    }
    std::ranges::stable_sort(all, {}, [&](const OutlineVariable* v) { return v->name != fault_.nearest; });
    if (all.size() > kMostLinks) all.resize(kMostLinks);
    const bool is_at_fault = task.name == fault_.task;
    for (const OutlineVariable* variable : all)
      offers.push_back(
          {(is_at_fault ? "link" : "link '" + port.name + "' of '" + task.name + '\'') + " to '" + variable->name + "'",
           {link(task, port, variable->name)}});
  }

  /// The first instance of a repeated port, or none of those that are too many.
  std::vector<Offer> instances(const OutlineTask& task) const {
    const auto port = std::ranges::find(task.repeated, fault_.port, &OutlineRepeated::name);
    const PortDescriptor* one = declared(task, fault_.port);
    if (port == task.repeated.end() || one == nullptr) return {};
    EditPath path = edit_path(fault_.path);
    const std::size_t n = std::stoul(fault_.found);
    std::vector<Offer> offers;
    OutlinePort first;
    first.name = one->name + "[0]";
    first.declared = one->name;
    first.kind = one->kind;
    first.unit = one->unit;
    if (n == 0) add_links(offers, task, first);
    if (n <= port->max_instances || path.size() != 4) return offers;
    Offer fewer{"take out all beyond " + std::to_string(port->max_instances), {}};
    path.emplace_back();
    for (std::size_t i = n; i-- > port->max_instances;) {
      path.back() = std::to_string(i);
      fewer.acts.push_back(RemoveValue{path});
    }
    return {fewer};
  }

  /// The outputs of a standby at the variables of its primary, in the order of both.
  std::vector<Offer> outputs_of_primary(const OutlineTask& task) const {
    std::vector<std::string> wanted = quoted_words(fault_.expected);
    std::vector<const OutlinePort*> free;
    for (const OutlinePort& port : task.ports)
      if (port.kind == CHIMERA_OUT_VAR && std::erase(wanted, port.variable) == 0) free.push_back(&port);
    Offer offer;
    for (std::size_t i = 0; i < std::min(wanted.size(), free.size()); ++i) {
      append_joined(offer.label, ", ", "link '" + free[i]->name + "' to '" + wanted[i] + "'");
      offer.acts.push_back(link(task, *free[i], wanted[i]));
    }
    if (!offer.acts.empty()) return {offer};
    std::vector<Offer> offers;
    for (const OutlinePort* port : free)
      if (port->variable == fault_.found) offers.push_back(apart(task, *port));
    return offers;
  }

  std::vector<Offer> without_standby() const {
    for (const DraftSet& set : draft_.configurations)
      for (const Word& name : set.tasks)
        if (set.name.text == fault_.set && name.text == fault_.found)
          return {
              {"take '" + name.text + "' out of '" + fault_.set + "'", {RemoveValue{draft_.keys->names(name.at.key)}}}};
    return {};
  }

  std::vector<Offer> addition(const DraftSet& set, const std::string& task) const {
    if (set.tasks.empty()) return {};
    return {{"add '" + task + "' to '" + set.name.text + "'", {member(set, task)}}};
  }

  /// The producers of other configurations.
  std::vector<Offer> additions() const {
    const auto variable = std::ranges::find(outline_.variables, fault_.found, &OutlineVariable::name);
    std::vector<Offer> offers;
    if (variable == outline_.variables.end()) return offers;
    for (const PortRef ref : variable->producers)
      for (const DraftSet& set : draft_.configurations)
        if (set.name.text == fault_.set) append(offers, addition(set, outline_.tasks[ref.task].name));
    return offers;
  }

  std::vector<Offer> joins(const OutlineTask& task, const OutlinePort& port) const {
    const auto set = std::ranges::find(outline_.configurations, fault_.set, &OutlineSet::name);
    const auto variable = std::ranges::find(outline_.variables, port.variable, &OutlineVariable::name);
    if (set == outline_.configurations.end() || variable == outline_.variables.end()) return {};
    const auto is_on = [&](const std::string& name) { return std::ranges::find(set->tasks, name) != set->tasks.end(); };
    JoinProducers act{variable->name, JoinBy::kMean, {}};
    for (const PortRef ref : variable->producers)
      if (const OutlineTask& producer = outline_.tasks[ref.task]; is_on(producer.name) || is_on(producer.standby_for))
        act.producers.push_back(task_port(outline_, ref));
    std::vector<Offer> offers;
    for (const auto& [by, label] :
         {std::pair{JoinBy::kMean, "join by mean"}, std::pair{JoinBy::kPriority, "join by priority"},
          std::pair{JoinBy::kSelect, "join by selection"}}) {
      act.by = by;
      offers.push_back({label, {act}});
    }
    offers.push_back(apart(task, port));
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

  const Fault& fault_;
  const Draft& draft_;
  const Library& library_;
  const Outline& outline_;
};

}  // namespace

std::vector<Offer> candidates_for(const Fault& fault, const Draft& draft, const Library& library,
                                  const Outline& outline) {
  return Candidates(fault, draft, library, outline).all();
}

}  // namespace chimera
