// SPDX-License-Identifier: Apache-2.0
// Reads NAME.test.yaml and makes a description with the component as its only task.
#include "chimera/component_test/setup.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/description/draft.h"

namespace chimera::component_test {
namespace {

constexpr std::string_view kPartner = "{partner}";

const NamedNode* find(const std::vector<NamedNode>& nodes, std::string_view name) {
  const auto found = std::ranges::find_if(nodes, [&](const NamedNode& node) { return node.name.text == name; });
  return found == nodes.end() ? nullptr : &*found;
}

const DraftAlias* find_alias(const DraftTask& task, std::string_view port) {
  const auto found = std::ranges::find_if(task.alias, [&](const DraftAlias& alias) { return alias.port.text == port; });
  return found == task.alias.end() ? nullptr : &*found;
}

/// Adds the missing parts of `draft` from `plain`, the generated description.
struct Filler {
  Draft& draft;
  const Draft& plain;
  const Descriptor& component;

  DraftTask& task() const { return draft.tasks[0]; }
  const DraftTask& plain_task() const { return plain.tasks[0]; }

  void fill() const {
    if (!task().rate && plain_task().rate) task().rate = plain_task().rate;
    for (const PortDescriptor& port : component.ports) {
      if (port.kind == CHIMERA_IN_CONST) fill_constant(port);
      if (port.kind == CHIMERA_IN_VAR) fill_input(port);
      if (port.kind == CHIMERA_OUT_VAR && port.repeated && find_alias(task(), port.name) == nullptr)
        task().alias.push_back(*find_alias(plain_task(), port.name));
    }
  }
  void fill_constant(const PortDescriptor& port) const {
    const DraftAlias* alias = find_alias(task(), port.name);
    if (port.repeated && alias != nullptr) return;
    const std::string& shared = alias != nullptr ? alias->variables[0].text : port.name;
    if (find(task().constants, port.name) != nullptr || find(draft.constants, shared) != nullptr) return;
    if (const NamedNode* value = find(plain_task().constants, port.name)) task().constants.push_back(*value);
  }
  void fill_input(const PortDescriptor& port) const {
    if (port.repeated && find_alias(task(), port.name) == nullptr)
      task().alias.push_back(*find_alias(plain_task(), port.name));
    const DraftAlias* alias = find_alias(task(), port.name);
    const std::size_t n = alias == nullptr ? 1 : alias->variables.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::string name = alias == nullptr ? port.name : alias->variables[i].text;
      if (find(draft.operators, name) != nullptr) continue;
      NamedNode node = *find(plain.operators, port.repeated ? port.name + "_0" : port.name);
      node.name.text = name;
      draft.operators.push_back(std::move(node));
    }
  }
};

void name_partner(Draft& draft, const Setup& setup) {
  for (NamedNode& resource : draft.tasks[0].resources)
    for (std::size_t at = 0; (at = resource.value.text.find(kPartner, at)) != std::string::npos;)
      resource.value.text.replace(at, kPartner.size(), setup.partner_text);
}

Verdict refuse(const std::string& file, Place at, const std::string& message, const std::string& remedy) {
  Verdict verdict{std::nullopt, Report(file)};
  verdict.report.add({"count-limit", at, message, {}, {}, {}, remedy});
  return verdict;
}

// No task reads the outputs, so this function settles their open units, extents and types.
Verdict judge_alone(const Draft& draft, const LibraryEntry& component, const UnitSystem& units) {
  Verdict verdict = verify(draft, Library::of_entries({component}, units));
  const bool is_open = verdict.report.has("unit-unsolved") || verdict.report.has("extent-unsolved") ||
                       verdict.report.has("type-unsolved");
  if (verdict.configuration || !is_open) return verdict;
  LibraryEntry plain = component;
  plain.descriptor = settled(component.descriptor);
  Verdict again = verify(draft, Library::of_entries({plain}, units));
  return again.configuration ? again : verdict;
}

}  // namespace

Verdict arrange(const Setup& setup, const LibraryEntry& component, const UnitSystem& units) {
  const Descriptor& descriptor = component.descriptor;
  const std::string plain_text = default_setup(descriptor);
  const ReadDescription plain = read_description(plain_text, descriptor.name + ".test.yaml (made up)");
  CHIMERA_ASSERT(plain.draft && plain.report.is_legal());
  if (setup.file.empty()) return judge_alone(*plain.draft, component, units);
  ReadDescription reading = read_description_file(setup.file);
  if (!reading.draft || !reading.report.is_legal()) return verify(reading, Library::of_entries({component}, units));
  Draft& draft = *reading.draft;
  if (draft.tasks.size() != 1 || draft.tasks[0].component.text != descriptor.name) {
    const Place at = draft.tasks.empty() ? Place{} : draft.tasks[0].name.at;
    return refuse(setup.file, at, "a test setup has one task, of the component " + descriptor.name,
                  "docs/formats/component-test.md shows one");
  }
  Filler{draft, *plain.draft, descriptor}.fill();
  name_partner(draft, setup);
  return judge_alone(draft, component, units);
}

}  // namespace chimera::component_test
