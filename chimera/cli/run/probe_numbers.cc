// SPDX-License-Identifier: Apache-2.0
// Names each number of a variable by index and field, with its unit.
#include "chimera/cli/run/probe_numbers.h"

namespace chimera::cli {

// Numbers of one element: of a struct all those of its fields.
std::vector<std::string> number_names(const Probe& probe) {
  std::vector<std::string> ends;
  if (probe.form.type != CHIMERA_STRUCT) ends.emplace_back();
  for (const FieldDescriptor& field : probe.form.fields)
    for (std::uint32_t i = 0; i < field.count && field.type != CHIMERA_STRING; ++i)
      ends.push_back("." + field.name + (field.count == 1 ? "" : "[" + std::to_string(i) + "]"));
  std::vector<std::string> names;
  for (std::uint32_t e = 0; e < probe.form.count; ++e)
    for (const std::string& end : ends)
      names.push_back(probe.name + (probe.form.is_scalar ? "" : "[" + std::to_string(e) + "]") + end);
  return names;
}

std::vector<std::string> number_units(const Probe& probe) {
  std::vector<std::string> of_one;
  if (probe.form.type != CHIMERA_STRUCT) of_one.push_back(probe.form.unit);
  for (const FieldDescriptor& field : probe.form.fields)
    if (field.type != CHIMERA_STRING) of_one.insert(of_one.end(), field.count, field.unit);
  std::vector<std::string> units;
  for (std::uint32_t e = 0; e < probe.form.count; ++e) units.insert(units.end(), of_one.begin(), of_one.end());
  return units;
}

}  // namespace chimera::cli
