// SPDX-License-Identifier: Apache-2.0
// Edits any bytes as a description. The first line is the act, as "set tasks/a/rate 1 kHz"; the rest is the text. The
// result is a refusal, or a text that has what was asked.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/testing/property.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/description/yaml_words.h"

namespace {

using namespace chimera;

/// The words of a line; the last one has the rest of it.
std::vector<std::string> words_of(std::string_view line, std::size_t most) {
  std::vector<std::string> words;
  while (!line.empty() && words.size() < most) {
    const std::size_t end = words.size() + 1 == most ? line.size() : std::min(line.find(' '), line.size());
    words.emplace_back(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  words.resize(most);
  return words;
}

EditAct act_of(std::string_view line) {
  const auto words = words_of(line, 4), three = words_of(line, 3);
  if (words[0] == "set") return SetValue{edit_path(three[1]), three[2]};
  if (words[0] == "remove") return RemoveValue{edit_path(words[1])};
  if (words[0] == "rename") return RenameKey{edit_path(words[1]), words[2], {}};
  if (words[0] == "add") return AddTask{words[1], words[2]};
  if (words[0] == "link") return LinkPort{words[1], words[2], words[3], {}};
  return JoinProducers{words[1], JoinBy::kSelect, {{words[2], "y"}, {words[3], "y"}}};
}

const Node* part_of(const Node& root, const EditPath& path) {
  const Node* node = &root;
  for (const std::string& part : path) {
    if (node == nullptr) return nullptr;
    if (node->is_map()) {
      node = node->find(part);
      continue;
    }
    std::size_t i = 0;
    while (i < node->items.size() &&
           std::to_string(i) != part.substr(std::min(part.find_first_not_of('0'), part.size() - 1)))
      ++i;
    node = i < node->items.size() ? &node->items[i] : nullptr;
  }
  return node;
}

/// `now` has all that `wanted` says; the keys of a map may have another order.
bool has_value(const Node& now, const Node& wanted) {
  if (!wanted.is_map()) {
    if (now.kind != wanted.kind || now.text != wanted.text || now.items.size() != wanted.items.size()) return false;
    for (std::size_t i = 0; i < now.items.size(); ++i)
      if (!has_value(now.items[i], wanted.items[i])) return false;
    return true;
  }
  for (const Word& key : wanted.keys)
    if (now.find(key.text) == nullptr || !has_value(*now.find(key.text), *wanted.find(key.text))) return false;
  return now.is_map() && now.keys.size() == wanted.keys.size();
}

#ifdef CHIMERA_PLANTED_DEFECT
/// A planted defect, to prove that the fuzzer finds one: a write beyond the end for a path of more than three parts.
void planted(const EditPath& path) {
  volatile char marks[4] = {};
  marks[std::min<std::size_t>(path.size(), 4)] = 1;
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(bytes), size);
  const std::size_t end = std::min(input.find('\n'), input.size());
  const EditAct act = act_of(input.substr(0, end));
  const std::string_view text = input.substr(std::min(end + 1, input.size()));
  const auto result = edit_text(text, {&act, 1});
  if (!result) {
    require(!result.error().message.view().empty(), "a refusal says why");
    return 0;
  }
  Report before, after;
  (void)read_yaml(text, before);
  const auto tree = read_yaml(*result, after);
  require(tree.has_value(), "the result can be read");
  require(after.errors() <= before.errors(), "the result has no new fault");
  if (const auto* set = std::get_if<SetValue>(&act)) {
#ifdef CHIMERA_PLANTED_DEFECT
    planted(set->path);
#endif
    const Node* part = part_of(*tree, set->path);
    const auto value = value_of(set->value);
    require(part != nullptr && value && has_value(*part, *value), "the value is there");
    const auto again = edit_text(*result, {&act, 1});
    require(again && *again == *result, "the same value again changes nothing");
  }
  return 0;
}
