// SPDX-License-Identifier: Apache-2.0
// Reads the text, changes its tree, splices the difference into the text, and proves the result by reading it.
#include "chimera/description/text_edit.h"

#include <algorithm>
#include <vector>

#include "chimera/description/edit_tree.h"
#include "chimera/description/text_splice.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/description/yaml_words.h"

namespace chimera {
namespace {

Error refusal(const Fault& fault) {
  const std::string where =
      fault.at.line == 0 ? "" : std::to_string(fault.at.line) + ":" + std::to_string(fault.at.column);
  return {ErrorCode::kRefused, std::string_view(sentence(fault)), std::string_view(where)};
}

std::vector<std::string_view> rules_of(const Report& report) {
  std::vector<std::string_view> rules;
  for (const Fault& fault : report.faults()) rules.push_back(fault.rule);
  std::sort(rules.begin(), rules.end());
  return rules;
}

}  // namespace

Result<std::string> edit_text(std::string_view text, std::span<const EditAct> acts) {
  Report faults;
  const std::optional<Node> old = read_yaml(text, faults);
  for (const Fault& fault : faults.faults())
    if (!old || fault.rule == "key-twice") return refusal(fault);
  if (!old) return Error{ErrorCode::kRefused, {"the text cannot be read"}, {}};
  Node now = *old;
  for (const EditAct& act : acts)
    if (const auto done = act_on(now, act); !done) return done.error();
  auto made = spliced(text, faults, *old, now);
  if (!made) return made;
  Report left;
  const std::optional<Node> read = read_yaml(*made, left);
  const auto before = rules_of(faults), after = rules_of(left);
  const bool has_new_fault = !std::includes(before.begin(), before.end(), after.begin(), after.end());
  if (!read || has_new_fault)
    for (const Fault& fault : left.faults())
      if (!std::binary_search(before.begin(), before.end(), fault.rule))
        return Error{ErrorCode::kRefused, {"after this edit: " + sentence(fault)}, {}};
  if (!read || has_new_fault || !is_same(*read, now))
    return Error{ErrorCode::kRefused, {"this edit cannot be proved in the form of this text: edit it by hand"}, {}};
  return made;
}

}  // namespace chimera
