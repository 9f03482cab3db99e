// SPDX-License-Identifier: Apache-2.0
// Reads values for operator variables by the rules of the description, and writes them back with their unit.
#include "chimera/manager/act/operator_values.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/descriptor_value.h"
#include "chimera/text/json.h"
#include "chimera/text/json_text.h"
#include "chimera/verify/setting.h"
#include "chimera/verify/verify.h"

namespace chimera::manager {
namespace {

Node scalar(std::string text, bool quoted = false) {
  Node node;
  node.kind = Node::Kind::kScalar;
  node.text = std::move(text);
  node.quoted = quoted;
  return node;
}

Node node_of(const Json& json, const ValueForm& form, const std::string& unit, std::uint32_t type);

Node list_node(const Json& json, const ValueForm& form, const std::string& unit, std::uint32_t type) {
  Node node;
  node.kind = Node::Kind::kList;
  for (const Json& item : json) node.items.push_back(node_of(item, form, unit, type));
  return node;
}

Node map_node(const Json& json, const ValueForm& form) {
  Node node;
  node.kind = Node::Kind::kMap;
  for (const auto& [key, value] : json.items()) {
    const auto field = std::find_if(form.fields.begin(), form.fields.end(),
                                    [&name = key](const FieldDescriptor& f) { return f.name == name; });
    // The rules refuse unknown fields later.
    const FieldDescriptor known = field == form.fields.end() ? FieldDescriptor{} : *field;
    node.keys.push_back({key, {}});
    node.items.push_back(node_of(value, form, known.unit, known.type));
  }
  return node;
}

Node node_of(const Json& json, const ValueForm& form, const std::string& unit, std::uint32_t type) {
  if (json.is_array()) return list_node(json, form, unit, type);
  if (json.is_object()) return map_node(json, form);
  if (json.is_number()) return scalar(with_unit(json.dump(), unit));
  if (json.is_string() && type == CHIMERA_STRING) return scalar(json.as_string(), true);
  if (json.is_string()) return written_value(json.as_string());
  return scalar(json.dump());
}

/// Cuts a flat list into the rows of a variable of two dimensions.
Json with_rows(const Json& json, const GivenSpec& given, const ValueForm& form) {
  const std::size_t columns = given.extent[1].max;
  if (columns <= 1 || !json.is_array() || json.size() != form.count || json.empty() || json[0].is_array()) return json;
  Json rows = Json::array();
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (i % columns == 0) rows.push_back(Json::array());
    rows.elements().back().push_back(json[i]);
  }
  return rows;
}

std::size_t operator_named(const ApplicationSpec& spec, std::string_view name) {
  std::size_t index = 0;
  while (index < spec.operators.size() && spec.operators[index].name != name) ++index;
  return index;
}

Error refused(const std::string& why, const std::string& variable) {
  return {ErrorCode::kBadInput, std::string_view(why), std::string_view(variable)};
}

/// Refuses a list that does not have the present extents of the variable.
Result<void> fits_extents(const GivenSpec& given, const ValueForm& form, const std::string& name) {
  std::uint32_t listed = 1;
  for (const std::uint32_t entries : given.listed) listed *= std::max(entries, 1u);
  if (given.listed[0] == 0 || listed == form.count) return {};
  return refused("found a list of " + std::to_string(listed) + "; expected " + std::to_string(form.count), name);
}

std::string unit_of(const Configuration& configuration, const std::string& name) {
  for (const ConfiguredVariable& variable : configuration.variables())
    if (variable.name == name) return variable.unit;
  return {};
}

std::string words(const Report& report) {
  std::string text;
  for (const Fault& fault : report.faults()) {
    if (fault.severity != Severity::kError) continue;
    append_joined(text, "; ", sentence(fault));
  }
  return text;
}

std::string plain(std::uint32_t type, std::span<const std::byte> at, const std::string& unit) {
  const PlainValue value = load_plain(type, at);
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* text = std::get_if<std::string>(&value)) return json_string(*text);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return with_unit(std::to_string(*whole), unit);
  const double number = std::get<double>(value);
  std::string finite = json_number(number);
  if (finite.ends_with(".0")) finite.resize(finite.size() - 2);  // a person writes 5, not 5.0
  return with_unit(finite == "null" ? (number > 0 ? "inf" : "-inf") : finite, unit);
}

template <class Item>
std::string listed(std::size_t count, const Item& item) {
  return "[" + join_n(count, ", ", item) + "]";
}

std::string element(const ValueForm& form, std::span<const std::byte> at) {
  if (form.type != CHIMERA_STRUCT) return plain(form.type, at, form.unit);
  return "{" + join(form.fields, ", ", [at](const FieldDescriptor& field) {
    const auto item = [&](std::size_t i) {
      return plain(field.type, at.subspan(field.offset + i * field.size, field.size), field.unit);
    };
    return field.name + ": " + (field.count == 1 ? item(0) : listed(field.count, item));
  }) + "}";
}

}  // namespace

Result<OperatorBytes> operator_bytes(const Configuration& configuration, const Library& library, const Json& values,
                                     const std::map<std::string, ValueForm>& forms) {
  Draft draft = configuration.draft();
  for (const auto& [name, value] : values.items()) {
    const ValueForm& form = forms.at(name);
    const ApplicationSpec& spec = configuration.spec();
    const Json rows = with_rows(value, spec.operators[operator_named(spec, name)], form);
    const auto given = std::ranges::find(draft.operators, name, [](const NamedNode& node) { return node.name.text; });
    if (given == draft.operators.end()) return refused(default_of_an_input(name), name);
    auto put = in_unit(node_of(rows, form, form.unit, form.type), form.unit, library.units());
    if (!put) return refused("operator variable '" + name + "': " + put.error().message.c_str(), name);
    given->value = *std::move(put);
  }
  const Verdict verdict = chimera::verify(draft, library);
  if (!verdict.configuration)
    return refused(words(verdict.report), values.size() == 1 ? (*values.items().begin()).first : std::string());
  OperatorBytes bytes;
  for (const auto& [name, value] : values.items()) {
    const std::size_t index = operator_named(verdict.configuration->spec(), name);
    const GivenSpec& given = verdict.configuration->spec().operators[index];
    const ValueForm& form = forms.at(name);
    if (const std::string unit = unit_of(*verdict.configuration, name); unit != form.unit && form.fields.empty())
      return refused("expected a quantity in \"" + form.unit + "\", found one in \"" + unit + "\"", name);
    if (const auto fits = fits_extents(given, form, name); !fits) return fits.error();
    bytes[index].assign(given.value.begin(), given.value.end());
  }
  return bytes;
}

std::string description_text(const ValueForm& form, std::span<const std::byte> bytes, std::size_t columns) {
  const auto item = [&](std::size_t i) {
    return element(form, bytes.subspan(i * form.element_bytes, form.element_bytes));
  };
  if (form.is_scalar) return item(0);
  if (columns == 0) return listed(form.count, item);
  return listed(form.count / columns, [&](std::size_t row) {
    return listed(columns, [&](std::size_t column) { return item(row * columns + column); });
  });
}

}  // namespace chimera::manager
