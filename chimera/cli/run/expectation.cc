// SPDX-License-Identifier: Apache-2.0
// Parses a comparison of a variable with a bound and judges it.
#include "chimera/cli/run/expectation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/text/decimal.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"
#include "chimera/verify/setting.h"

namespace chimera::cli {
namespace {

Error wrong_expectation(const std::string& why) { return {ErrorCode::kBadInput, std::string_view(why), {}}; }

bool compare(double value, const std::string& op, double bound) {
  if (op == "<") return value < bound;
  if (op == "<=") return value <= bound;
  if (op == ">") return value > bound;
  return value >= bound;
}

// The quantity of `text`, behind the comparison.
std::string quantity_of(const std::string& text, const std::string& op) {
  return trimmed(text.substr(text.find_first_of("<>") + op.size()));
}

}  // namespace

Result<const ConfiguredVariable*> find_variable(const Configuration& configuration, const std::string& name) {
  std::vector<std::string> names;
  for (const ConfiguredVariable& variable : configuration.variables()) {
    if (variable.is_constant) continue;
    if (variable.name == name) return &variable;
    names.push_back(variable.name);
  }
  const std::string constant = about_constant(configuration, name);
  const std::string why = constant.empty() ? no_such("state variable", name, names) : constant;
  return Error{ErrorCode::kNotFound, {why}, {configuration.file()}};
}

Result<Expectation> Expectation::with_bound(const std::string& text, const Bound& bound) {
  const std::size_t at = text.find_first_of("<>");
  if (at == std::string::npos) return wrong_expectation("write 'VARIABLE <= QUANTITY', with < <= > or >=");
  Expectation made;
  made.text_ = text;
  made.bound_ = bound;
  made.op_ = text.substr(at, at + 1 < text.size() && text[at + 1] == '=' ? 2 : 1);
  made.variable_ = trimmed(text.substr(0, at));
  if (made.variable_.starts_with("end ")) made.variable_ = trimmed(made.variable_.substr(4));
  if (made.variable_.size() > 2 && made.variable_.front() == '|' && made.variable_.back() == '|') {
    made.magnitude_ = true;
    made.variable_ = trimmed(made.variable_.substr(1, made.variable_.size() - 2));
  }
  return made;
}

Result<Expectation> Expectation::parse(const std::string& text, const Configuration& configuration,
                                       const UnitSystem& units) {
  auto made = read(text, configuration, units);
  if (made) return made;
  return wrong_expectation("--expect '" + text + "': " + made.error().message.c_str());
}

Result<Expectation> Expectation::read(const std::string& text, const Configuration& configuration,
                                      const UnitSystem& units) {
  auto made = with_bound(text, {});
  if (!made) return made;
  const auto found = find_variable(configuration, made->variable_);
  if (!found) return wrong_expectation(found.error().message.c_str());
  const ConfiguredVariable& variable = **found;
  constexpr std::array kNumbers = {"bool", "int32", "int64", "float32", "float64"};
  if (std::find(kNumbers.begin(), kNumbers.end(), variable.type) == kNumbers.end())
    return wrong_expectation(variable.name + " is not a number or a list of numbers");
  const auto quantity = parse_quantity(quantity_of(text, made->op_), units);
  if (!quantity) return wrong_expectation(quantity.error().message.c_str());
  const auto unit = units.parse(variable.unit);
  if (!unit) return wrong_expectation(unit.error().message.c_str());
  const auto bound = value_in(*quantity, *unit, variable.unit);
  if (!bound) return wrong_expectation(bound.error().message.c_str());
  made->bound_ = {*bound, *conversion(*unit, quantity->unit)};
  return made;
}

std::string Expectation::value_text(const std::vector<double>& values, const std::string& as_is) const {
  const Conversion& to = bound_.to_written;
  const std::string quantity = quantity_of(text_, op_);
  const auto number = read_decimal(quantity);
  const std::string unit = number ? trimmed(quantity.substr(number->length)) : "";
  const bool is_alike = to.factor == 1 && to.offset == 0 && (unit.empty() || as_is.ends_with(" " + unit));
  if (!number || is_alike) return as_is;
  const std::string list = join(values, " ", [&to](double value) { return formatted("%.6g", to(value)); });
  return with_unit(values.size() == 1 ? list : "[" + list + "]", unit.empty() ? "1" : unit);
}

bool Expectation::holds(const Seen& seen, std::string& said) const {
  said = variable_ + (seen.is_written ? " is " + value_text(seen.numbers, seen.text) : " was never written");
  return seen.is_written && std::all_of(seen.numbers.begin(), seen.numbers.end(), [this](double value) {
           return compare(magnitude_ ? std::fabs(value) : value, op_, bound_.value);
         });
}

}  // namespace chimera::cli
