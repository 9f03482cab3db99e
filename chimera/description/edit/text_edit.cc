// SPDX-License-Identifier: Apache-2.0
// Reads the text, changes its tree, splices the difference into the text, and proves the result by reading it.
#include "chimera/description/edit/text_edit.h"

#include <algorithm>
#include <vector>

#include "chimera/description/edit/edit_tree.h"
#include "chimera/description/edit/text_splice.h"
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

Result<std::string> edited(const std::string& text, const EditAct& act) {
  Report faults;
  const std::optional<Node> old = read_yaml(text, faults);
  for (const Fault& fault : faults.faults())
    if (!old || fault.rule == "key-twice") return refusal(fault);
  if (!old) return Error{ErrorCode::kRefused, {"the text cannot be read"}, {}};
  Node now = *old;
  if (const auto done = act_on(now, act); !done) return done.error();
  if (is_same(*old, now)) return text;
  auto made = spliced(text, faults, *old, now);
  if (!made) return made;
  Report left;
  const std::optional<Node> read = read_yaml(*made, left);
  const auto before = rules_of(faults), after = rules_of(left);
  if (read && is_same(*read, now) && std::includes(before.begin(), before.end(), after.begin(), after.end()))
    return made;
  for (const Fault& fault : left.faults())
    if (!std::binary_search(before.begin(), before.end(), fault.rule))
      return Error{ErrorCode::kRefused, {"after this edit: " + sentence(fault)}, {}};
  return Error{ErrorCode::kRefused, {"this edit cannot be proved in the form of this text: edit it by hand"}, {}};
}

}  // namespace

Result<std::string> edit_text(std::string_view text, std::span<const EditAct> acts) {
  Result<std::string> now = std::string(text);
  for (const EditAct& act : acts)
    if (now) now = edited(*now, act);
  return now;
}

}  // namespace chimera
