// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/expectation.h"

#include <cmath>

#include "chimera/config/quantity.h"

namespace chimera::desk {
namespace {

Error wrong(const std::string& text, const std::string& why) {
  return {ErrorCode::kBadInput, {"--expect '" + text + "': " + why}, {}};
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

bool compare(double value, const std::string& op, double bound) {
  if (op == "<") return value < bound;
  if (op == "<=") return value <= bound;
  if (op == ">") return value > bound;
  return value >= bound;
}

}  // namespace

Result<Expectation> Expectation::parse(const std::string& text, const Application& application,
                                       const UnitSystem& units) {
  const std::size_t at = text.find_first_of("<>");
  if (at == std::string::npos) return wrong(text, "write 'VARIABLE <= QUANTITY', with < <= > or >=");
  Expectation made;
  made.text_ = text;
  made.op_ = text.substr(at, at + 1 < text.size() && text[at + 1] == '=' ? 2 : 1);
  std::string name = trimmed(text.substr(0, at));
  if (name.size() > 2 && name.front() == '|' && name.back() == '|') {
    made.magnitude_ = true;
    name = trimmed(name.substr(1, name.size() - 2));
  }
  auto probe = application.probe(name);
  if (!probe) return wrong(text, probe.error().message.c_str());
  made.probe_ = *std::move(probe);
  if (made.probe_.form.type == CHIMERA_STRUCT || made.probe_.form.type == CHIMERA_STRING)
    return wrong(text, name + " is not a number or a list of numbers");
  const auto quantity = parse_quantity(trimmed(text.substr(at + made.op_.size())), units);
  if (!quantity) return wrong(text, quantity.error().message.c_str());
  const auto unit = units.parse(made.probe_.form.unit);
  if (!unit) return wrong(text, unit.error().message.c_str());
  const auto bound = value_in(*quantity, *unit, made.probe_.form.unit);
  if (!bound) return wrong(text, bound.error().message.c_str());
  made.bound_ = *bound;
  return made;
}

bool Expectation::holds(std::string& said) const {
  std::vector<std::byte> bytes;
  if (!probe_.read(bytes)) {
    said = probe_.name + " was never written";
    return false;
  }
  said = probe_.name + " is " + value_text(probe_.form, bytes);
  bool all = true;
  for (double value : numbers(probe_.form, bytes))
    all = all && compare(magnitude_ ? std::fabs(value) : value, op_, bound_);
  return all;
}

}  // namespace chimera::desk
