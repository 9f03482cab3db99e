// SPDX-License-Identifier: Apache-2.0
// Plans offsets of groups and variables, and hashes the plan.
#include "chimera/table/layout.h"

#include "chimera/base/assert.h"
#include "chimera/base/message.h"
#include "chimera/table/slot.h"

namespace chimera {
namespace {

class Fnv1a {
 public:
  void add(std::string_view text) noexcept {
    for (const char c : text) add_byte(static_cast<unsigned char>(c));
    add_byte(0);
  }
  void add(std::uint64_t number) noexcept {
    for (int i = 0; i < 8; ++i) add_byte(static_cast<unsigned char>(number >> (8 * i)));
  }
  std::uint64_t value() const noexcept { return value_; }

 private:
  void add_byte(unsigned char b) noexcept { value_ = (value_ ^ b) * 0x100000001b3u; }
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

// Places the variables of `spec` one after another. Returns the bytes of the payload, or the reason of a refusal.
Result<std::uint32_t> place_variables(const GroupSpec& spec, GroupId group, std::span<VariablePlace> places) noexcept {
  if (spec.variables.size() > kMaxGroupVariables)
    return (Message() << spec.owner << " publishes " << spec.variables.size() << " variables, at most "
                      << kMaxGroupVariables << " fit one group")
        .error(ErrorCode::kRefused);
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < spec.variables.size(); ++i) {
    const VariableSpec& variable = spec.variables[i];
    const std::uint64_t bytes = std::uint64_t{variable.element_bytes} * variable.max_count;
    if (bytes == 0)
      return (Message() << spec.owner << "." << variable.name << " has no bytes: " << variable.max_count
                        << " elements of " << variable.element_bytes << " bytes")
          .error(ErrorCode::kBadInput);
    if (bytes > kMaxPayloadBytes - offset)
      return (Message() << spec.owner << "." << variable.name << " of " << bytes << " bytes brings its group to "
                        << offset + bytes << " bytes, at most " << kMaxPayloadBytes << " are allowed")
          .error(ErrorCode::kRefused);
    places[i] = {group, static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(bytes),
                 static_cast<std::uint32_t>(i)};
    offset += round_to_value(static_cast<std::uint32_t>(bytes));
  }
  return static_cast<std::uint32_t>(offset);
}

void add_group(Fnv1a& hash, const GroupSpec& spec, const GroupPlace& place) noexcept {
  hash.add(spec.owner);
  hash.add(place.offset);
  hash.add(spec.variables.size());
  for (const VariableSpec& variable : spec.variables) {
    hash.add(variable.name);
    hash.add(std::uint64_t{variable.element_bytes});
    hash.add(std::uint64_t{variable.max_count});
  }
}

}  // namespace

std::uint32_t TableLayout::count_variables(std::span<const GroupSpec> specs) noexcept {
  std::size_t n = 0;
  for (const GroupSpec& spec : specs) n += spec.variables.size();
  return static_cast<std::uint32_t>(n);
}

Result<TableLayout> TableLayout::plan(std::span<const GroupSpec> specs, std::uint64_t available_bytes,
                                      std::span<GroupPlace> groups, std::span<VariablePlace> variables) noexcept {
  const std::uint32_t n_variables = count_variables(specs);
  CHIMERA_ASSERT(groups.size() >= specs.size());
  CHIMERA_ASSERT(variables.size() >= n_variables);
  Fnv1a hash;
  std::uint64_t offset = 0;  // cannot overflow: below 2^32 groups of at most 2^27 bytes
  std::uint32_t first = 0;
  for (std::size_t g = 0; g < specs.size(); ++g) {
    const GroupSpec& spec = specs[g];
    const auto n = static_cast<std::uint32_t>(spec.variables.size());
    const Result<std::uint32_t> payload = place_variables(spec, GroupId(g), variables.subspan(first, n));
    if (!payload) return payload.error();
    groups[g] = {offset, payload.value(), first, n};
    add_group(hash, spec, groups[g]);
    offset += group_bytes(payload.value());
    first += n;
  }
  if (offset > available_bytes)
    return (Message() << "the table needs " << offset << " bytes for " << specs.size() << " groups, the region has "
                      << available_bytes << ": " << offset - available_bytes << " too few")
        .error(ErrorCode::kRefused);
  TableLayout layout;
  layout.groups_ = groups.first(specs.size());
  layout.variables_ = variables.first(n_variables);
  layout.region_bytes_ = offset;
  layout.hash_ = hash.value();
  return layout;
}

const GroupPlace& TableLayout::group(GroupId id) const noexcept {
  CHIMERA_ASSERT(id.index < groups_.size());
  return groups_[id.index];
}

const VariablePlace& TableLayout::variable(GroupId id, std::uint32_t index) const noexcept {
  const GroupPlace& place = group(id);
  CHIMERA_ASSERT(index < place.variables);
  return variables_[place.first_variable + index];
}

}  // namespace chimera
