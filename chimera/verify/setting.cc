// SPDX-License-Identifier: Apache-2.0
// Puts values from the command line into a draft or a configuration.
#include "chimera/verify/setting.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/library.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/description/yaml_words.h"
#include "chimera/text/json_text.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera {
namespace {

/// "[1 2] rad", the form of output, becomes "[1 rad, 2 rad]".
std::string spread_unit(const std::string& text) {
  const std::size_t end = text.rfind(']');
  if (text.empty() || text[0] != '[' || end == std::string::npos) return text;
  const std::size_t unit = text.find_first_not_of(' ', end + 1);
  if (unit == std::string::npos && text.find(',') != std::string::npos) return text;
  const std::string with = unit == std::string::npos ? "" : " " + text.substr(unit);
  std::string items;
  for (std::size_t at = 1, next = 0; at < end; at = next + 1) {
    next = std::min(text.find_first_of(" ,", at), end);
    if (next > at) append_joined(items, ", ", text.substr(at, next - at) + with);
  }
  return "[" + items + "]";
}

void place(Node& node, Place at) {
  node.at = at;
  for (Word& key : node.keys) key.at = at;
  for (Node& item : node.items) place(item, at);
}

NamedNode* named(std::vector<NamedNode>& list, const std::string& name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&name](const NamedNode& node) { return node.name.text == name; });
  return found == list.end() ? nullptr : &*found;
}

/// Puts settings into a draft, and remembers their places.
class AppliedSettings {
 public:
  /// `keeps_units`: in_unit(), by these.
  AppliedSettings(const Configuration& configuration, std::span<const Setting> settings,
                  const UnitSystem* keeps_units = nullptr)
      : configuration_(configuration), settings_(settings), keeps_units_(keeps_units), draft_(configuration.draft()) {}

  Result<void> put_all() {
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k)
        if (settings_[k].name == settings_[i].name)
          return refuse(settings_[i], "'" + settings_[i].name + "' is set twice", {});
      if (settings_[i].name.starts_with("rtpus.")) {
        if (auto placed = place_rtpu(settings_[i]); !placed) return placed;
        places_.emplace_back();
        continue;
      }
      NamedNode* target = nullptr;
      if (auto found = find(settings_[i], target); !found) return found;
      const Place at = target->value.is_none() ? target->name.at : target->value.at;
      auto value = node_of(settings_[i]);
      if (!value)
        return refuse(settings_[i],
                      "operator variable '" + settings_[i].name + "': " + value.error().message.c_str(), at);
      target->value = *std::move(value);
      place(target->value, at);
      places_.push_back(at);
    }
    return {};
  }

  const Draft& draft() const { return draft_; }

  Error refuse(const Setting& setting, const std::string& why, Place at) const {
    return {ErrorCode::kBadInput, {setting.said + ": " + why}, {where(at)}};
  }

  const ConfiguredVariable* variable(const std::string& name) const {
    for (const ConfiguredVariable& known : configuration_.variables())
      if (known.name == name) return &known;
    return nullptr;
  }

  /// The errors of a report as one error, each after the settings that caused it.
  Error refusal(const Report& report) const {
    std::string text;
    Place first;
    for (const Fault& fault : report.faults()) {
      if (fault.severity != Severity::kError) continue;
      if (text.empty()) first = fault.at;
      append_joined(text, "; ", authors(fault.at) + ": " + sentence(fault));
    }
    return {ErrorCode::kBadInput, {text}, {where(first)}};
  }

 private:
  std::string where(Place at) const {
    if (at.line == 0) return configuration_.file();
    return configuration_.file() + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
  }
  std::string authors(Place at) const {
    std::string those, all;
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      if (places_[i] == at) append_joined(those, ", ", settings_[i].said);
      append_joined(all, ", ", settings_[i].said);
    }
    return those.empty() ? all : those;
  }

  /// A text for a port of texts stays unchanged; any other text is parsed like a description.
  Result<Node> node_of(const Setting& setting) const {
    const ConfiguredVariable* known = variable(setting.name);
    if (known == nullptr || known->type != "string" || !known->shape.empty()) {
      Node value = written_value(setting.value);
      if (known == nullptr || keeps_units_ == nullptr) return value;
      return in_unit(std::move(value), known->unit, *keeps_units_);
    }
    Node node;
    node.kind = Node::Kind::kScalar;
    node.quoted = true;
    node.text = setting.value;
    return node;
  }

  /// "rtpus.NAME.cpu".
  Result<void> place_rtpu(const Setting& setting) {
    std::string name = setting.name.substr(setting.name.find('.') + 1);
    if (name.ends_with(".cpu")) name.resize(name.size() - 4);
    if (draft_.rtpus.empty()) draft_.rtpus.emplace_back().name.text = "main";
    const auto found = std::ranges::find(draft_.rtpus, name, [](const DraftRtpu& rtpu) { return rtpu.name.text; });
    const auto names = names_of(draft_.rtpus, [](const DraftRtpu& rtpu) { return rtpu.name.text; });
    if (found == draft_.rtpus.end()) return refuse(setting, chimera::no_such("rtpu", name, names), {});
    const std::string& text = setting.value;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), found->cpu.value);
    if (fault == std::errc() && end == text.data() + text.size() && found->cpu.value <= kLastCpu) return {};
    return refuse(setting, "expected RTPU=N, N from 0 to " + std::to_string(kLastCpu), {});
  }

  Result<void> find(const Setting& setting, NamedNode*& target) {
    const std::size_t dot = setting.name.find('.');
    if (const ConfiguredVariable* known = variable(setting.name); dot != std::string::npos && known != nullptr)
      return refuse(setting, default_of_an_input(setting.name), known->at);
    if (dot != std::string::npos) return find_of_task(setting, dot, target);
    target = named(draft_.operators, setting.name);
    if (target == nullptr) target = named(draft_.constants, setting.name);
    return target != nullptr ? Result<void>() : Result<void>(no_such(setting));
  }

  Result<void> find_of_task(const Setting& setting, std::size_t dot, NamedNode*& target) {
    const std::string task = setting.name.substr(0, dot), constant = setting.name.substr(dot + 1);
    std::vector<std::string> names;
    for (DraftTask& known : draft_.tasks) {
      names.push_back(known.name.text);
      if (known.name.text != task) continue;
      target = named(known.constants, constant);
      if (target != nullptr) return {};
      known.constants.push_back({{constant, known.name.at}, {}});
      target = &known.constants.back();
      return {};
    }
    return refuse(setting, chimera::no_such("task", task, names), {});
  }

  Error no_such(const Setting& setting) const {
    if (const ConfiguredVariable* known = variable(setting.name); known != nullptr) {
      const ConfiguredTask* task =
          known->producers.empty() ? nullptr : &configuration_.tasks()[known->producers[0].task];
      return refuse(setting,
                    "'" + setting.name + "' is produced by " +
                        (task == nullptr ? "a task" : "task '" + task->name + "'") +
                        "; operator variables and constants of the file can be set",
                    known->at);
    }
    std::vector<std::string> names;
    for (const auto* list : {&draft_.operators, &draft_.constants})
      for (const NamedNode& known : *list) names.push_back(known.name.text);
    std::string hint = did_you_mean(nearest(setting.name, names));
    for (const ConfiguredTask& task : configuration_.tasks())
      for (const ConfiguredPort& port : task.ports)
        if (hint.empty() && port.kind == CHIMERA_IN_CONST && port.name == setting.name)
          hint = "; task '" + task.name + "' has a constant of that name: '" + task.name + "." + port.name + "'";
    return refuse(setting, "the file has no operator variable or constant '" + setting.name + "'" + hint, {});
  }

  const Configuration& configuration_;
  std::span<const Setting> settings_;
  const UnitSystem* keeps_units_;
  std::vector<Place> places_;
  Draft draft_;
};

/// Converts each number of `now` to the unit of the number at its place in `written`.
Node in_units_of(const Node& written, Node now, const UnitSystem& units) {
  for (std::size_t i = 0; i < now.items.size(); ++i) {
    const Node* like = &written;
    if (now.is_map() && written.is_map()) like = written.find(now.keys[i].text);
    else if (now.is_list() && written.is_list()) like = &written.items[std::min(i, written.items.size() - 1)];
    if (like != nullptr) now.items[i] = in_units_of(*like, std::move(now.items[i]), units);
  }
  const auto quantity = parse_quantity(written.text, units);
  if (!now.is_scalar() || !quantity) return now;
  const auto made = in_unit(now, quantity->unit_text, units);
  return made ? *made : now;
}

}  // namespace

Node written_value(const std::string& text) {
  Report report;
  const auto tree = read_yaml("value: " + spread_unit(text), report);
  const Node* value = tree ? tree->find("value") : nullptr;
  if (value != nullptr && report.is_legal() && tree->keys.size() == 1) return *value;
  Node node;
  node.kind = Node::Kind::kScalar;
  node.text = text;
  return node;
}

Result<Configuration> with_settings(const Configuration& configuration, const Library& library,
                                    std::span<const Setting> settings, Overload overload) {
  if (settings.empty()) return configuration;
  AppliedSettings applied(configuration, settings);
  if (auto put = applied.put_all(); !put) return put.error();
  const Verdict verdict = verify({applied.draft(), Report(configuration.file()), {}}, library, overload);
  if (!verdict.configuration) return applied.refusal(verdict.report);
  return *verdict.configuration;
}

std::string default_of_an_input(const std::string& variable) {
  const std::string port = variable.substr(variable.find('.') + 1);
  return "'" + variable + "' is the default of an input: write '" + port + "' under operator: to set it";
}

std::string about_constant(const Configuration& configuration, const std::string& name) {
  const Draft& draft = configuration.draft();
  for (std::size_t t = 0; t < configuration.tasks().size(); ++t)
    for (const ConfiguredPort& port : configuration.tasks()[t].ports) {
      const std::string& task = configuration.tasks()[t].name;
      if (port.kind != CHIMERA_IN_CONST) continue;
      if (port.name != name && port.variable != name && task + "." + port.name != name) continue;
      std::string value = "default";
      for (const ConfiguredVariable& made : configuration.variables())
        if (made.name == port.variable && !made.producers.empty())
          value = "made by task '" + configuration.tasks()[made.producers[0].task].name + "'";
      for (const NamedNode& given : draft.constants)
        if (given.name.text == port.variable) value = written_text(given.value);
      for (const NamedNode& own : draft.tasks[t].constants)
        if (own.name.text == port.name) value = written_text(own.value);
      return "'" + name + "' is a constant of task '" + task + "' (" + value +
             "): nothing changes it while tasks run. Change it in the file and start again; an input under operator: "
             "can be set at any time";
    }
  return {};
}

Result<void> knows(const Configuration& configuration, std::span<const Setting> settings) {
  return AppliedSettings(configuration, settings).put_all();
}

Result<Node> in_unit(Node value, const std::string& unit, const UnitSystem& units) {
  if (value.is_map()) return value;  // each field of a struct has its own unit
  for (Node& item : value.items) {
    auto made = in_unit(std::move(item), unit, units);
    if (!made) return made;
    item = *std::move(made);
  }
  if (!value.is_scalar() || value.quoted) return value;
  const auto quantity = parse_quantity(value.text, units);
  const auto wanted = units.parse(unit);
  if (!quantity || !wanted || quantity->unit_text == unit) return value;
  const auto number = value_in(*quantity, *wanted, unit);
  if (!number && number.error().code != ErrorCode::kRefused) return number.error();
  // If the value is not finite in this unit, the rules report it.
  char digits[32];
  char* const end = std::to_chars(digits, digits + sizeof digits, number ? *number : INFINITY).ptr;
  value.text = with_unit(std::string(digits, end), unit);
  return value;
}

std::string in_words_of(const Node& written, const std::string& now, const UnitSystem& units) {
  const Node before = written_value(now);
  const std::string text = written_text(in_units_of(written, before, units));
  return text == written_text(before) ? now : text;
}

Result<Configuration> with_new_value(const Configuration& configuration, const Library& library,
                                     const Setting& setting) {
  AppliedSettings applied(configuration, {&setting, 1}, &library.units());
  if (auto put = applied.put_all(); !put) return put.error();
  const Verdict verdict = verify(applied.draft(), library);
  if (!verdict.configuration) return applied.refusal(verdict.report);
  const ConfiguredVariable* before = applied.variable(setting.name);
  for (const ConfiguredVariable& now : verdict.configuration->variables()) {
    if (now.name != setting.name || before == nullptr) continue;
    if (now.unit != before->unit)
      return applied.refuse(
          setting, "expected a quantity in \"" + before->unit + "\", found one in \"" + now.unit + "\"", before->at);
    if (now.type != before->type || now.shape != before->shape)
      return applied.refuse(setting, "expected " + before->type + before->shape + ", found " + now.type + now.shape,
                            before->at);
  }
  return *verdict.configuration;
}

}  // namespace chimera
