// SPDX-License-Identifier: Apache-2.0
// Sets, removes, adds and links parts of the tree of a description.
#include "chimera/description/edit/edit_tree.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <span>
#include <utility>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/edit/join_tree.h"
#include "chimera/description/keys.h"
#include "chimera/description/sequence.h"
#include "chimera/description/edit/rename_tree.h"
#include "chimera/description/edit/same_value.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/description/yaml_words.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

std::vector<std::string> keys_of(const Node& node) { return names_of(node.keys, &Word::text); }

std::optional<std::size_t> index_of(const std::string& part) {
  std::size_t index = 0;
  const auto [end, fault] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (part.empty() || fault != std::errc{} || end != part.data() + part.size()) return std::nullopt;
  return index;
}

/// The only keys that may stand at `path`, in their usual order; empty: any name.
std::span<const std::string_view> keys_at(const EditPath& path) {
  if (path.empty()) return kFileKeys;
  const std::string& section = path[0];
  if (path.size() == 2 && section == "tasks") return kTaskKeys;
  if (path.size() == 2 && section == "rtpus") return kRtpuKeys;
  if (path.size() == 2 && section == "configurations") return kSetKeys;
  if (section == "sequence" && path.size() == 1) return kSequenceKeys;
  if (section == "sequence" && index_of(path.back())) return kStepKeys;
  if (path.size() != 3 || section != "tasks") return {};
  if (path[2] == "server") return kServerKeys;
  if (path[2] == "tolerate") return kTolerateKeys;
  if (path[2] == "standby_for") return kStandbyKeys;
  return {};
}

/// Kind of the thing that the key at `path` names: "task" for tasks/NAME.
std::string kind_of(const EditPath& path) {
  if (path.size() != 2) return "key";
  if (path[0] == "tasks") return "task";
  if (path[0] == "rtpus") return "rtpu";
  if (path[0] == "configurations") return "configuration";
  if (path[0] == "operator") return "operator variable";
  return path[0] == "constants" ? "constant" : "key";
}

Node* child_of(Node& node, const std::string& name) {
  if (node.is_map()) return const_cast<Node*>(std::as_const(node).find(name));
  const auto index = node.is_list() ? index_of(name) : std::nullopt;
  return index && *index < node.items.size() ? &node.items[*index] : nullptr;
}

Error missing(const Node& parent, const EditPath& path) {
  const std::string list = parent.is_list() ? "the list has " + counted(parent.items.size(), "item") : "";
  return {ErrorCode::kNotFound,
          {list.empty() ? no_such(kind_of(path), path.back(), keys_of(parent)) : list},
          {text_of(path)}};
}

/// Where a new key goes: behind the keys that usually stand before it, else at the end.
std::size_t place_for(const Node& map, const std::string& key, std::span<const std::string_view> order) {
  const auto rank = [&](std::string_view name) { return std::find(order.begin(), order.end(), name) - order.begin(); };
  if (order.empty()) return map.keys.size();
  std::size_t place = 0;
  for (std::size_t i = 0; i < map.keys.size(); ++i)
    if (rank(map.keys[i].text) < rank(key)) place = i + 1;
  return place;
}

/// The new part `path` of `parent`.
Result<Node*> made_child(Node& parent, const EditPath& path, bool is_named_thing) {
  const std::string& name = path.back();
  const EditPath above(path.begin(), path.end() - 1);
  const auto order = keys_at(above);
  if (parent.is_none()) parent.kind = index_of(name) ? Node::Kind::kList : Node::Kind::kMap;
  if (parent.is_list()) {
    const auto index = index_of(name);
    if (!index) return no_edit(above, "is a list: set it as a whole, or name an item by its number");
    if (*index != parent.items.size()) return missing(parent, path);
    return &parent.items.emplace_back();
  }
  if (!parent.is_map()) return no_edit(above, "has a value without parts: set it as a whole");
  if (is_named_thing || (!order.empty() && std::find(order.begin(), order.end(), name) == order.end()))
    return Error{ErrorCode::kNotFound,
                 {no_such(kind_of(path), name,
                          is_named_thing ? keys_of(parent) : std::vector<std::string>(order.begin(), order.end()))},
                 {text_of(path)}};
  if (const auto legal = check_new_name(path, name); !legal) return legal.error();
  const std::size_t at = place_for(parent, name, order);
  insert_key(parent, at, name, {});
  return &parent.items[at];
}

/// Gives `node` the value `now`. Parts that stay keep their places: items by number, keys by name.
void graft(Node& node, Node now) {
  if (node.kind != now.kind || node.is_scalar() || node.is_none()) {
    now.at = node.at;
    node = std::move(now);
    return;
  }
  if (node.is_list()) {
    const std::size_t common = std::min(node.items.size(), now.items.size());
    for (std::size_t i = 0; i < common; ++i) graft(node.items[i], std::move(now.items[i]));
    node.items.resize(common);
    std::move(now.items.begin() + static_cast<std::ptrdiff_t>(common), now.items.end(), std::back_inserter(node.items));
    return;
  }
  for (std::size_t i = node.keys.size(); i-- > 0;) {
    if (now.find(node.keys[i].text) != nullptr) continue;
    node.keys.erase(node.keys.begin() + static_cast<std::ptrdiff_t>(i));
    node.items.erase(node.items.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (std::size_t i = 0; i < now.keys.size(); ++i) {
    if (Node* known = child_of(node, now.keys[i].text))
      graft(*known, std::move(now.items[i]));
    else
      insert_key(node, node.keys.size(), now.keys[i].text, std::move(now.items[i]));
  }
}

Result<void> act(Node& root, const SetValue& set) {
  if (set.path.empty()) return no_edit(set.path, "the path is empty");
  auto value = value_of(set.value);
  if (!value) return no_edit(set.path, value.error().message.c_str());
  const auto place = made(root, set.path);
  if (!place) return place.error();
  graft(**place, set.units != nullptr ? as_written(**place, *std::move(value), *set.units) : *std::move(value));
  return {};
}

Result<void> act(Node& root, const RemoveValue& remove) {
  if (remove.path.empty()) return no_edit(remove.path, "the path is empty");
  Node* parent = &root;
  for (std::size_t i = 0; i + 1 < remove.path.size(); ++i) {
    Node* child = child_of(*parent, remove.path[i]);
    if (child == nullptr)
      return missing(*parent, EditPath(remove.path.begin(), remove.path.begin() + static_cast<std::ptrdiff_t>(i) + 1));
    parent = child;
  }
  const Node* gone = child_of(*parent, remove.path.back());
  if (gone == nullptr) return missing(*parent, remove.path);
  const auto at = gone - parent->items.data();
  if (parent->is_map()) parent->keys.erase(parent->keys.begin() + at);
  parent->items.erase(parent->items.begin() + at);
  return {};
}

Result<void> act(Node& root, const AddTask& add) {
  const EditPath path = {"tasks", add.name};
  for (const std::string& name : {add.name, add.component})
    if (const auto legal = check_new_name(path, name); !legal) return legal;
  if (found(root, path) != nullptr) return no_edit(path, "there is a task '" + add.name + "' already");
  if (root.is_none() || (root.is_map() && root.find("subsystem") == nullptr)) {
    const auto subsystem = made(root, {"subsystem"});
    if (!subsystem) return subsystem.error();
    **subsystem = scalar_node(add.subsystem);
  }
  const auto task = made(root, path);
  if (!task) return task.error();
  (*task)->kind = Node::Kind::kMap;
  if (add.component != add.name) insert_key(**task, 0, "component", scalar_node(add.component));
  return {};
}

Result<void> act(Node& root, const LinkPort& link) { return link_port(root, link); }
Result<void> act(Node& root, const RenameKey& rename) { return rename_key(root, rename); }
Result<void> act(Node& root, const JoinProducers& join) { return join_producers(root, join); }

}  // namespace

Error no_edit(const EditPath& path, const std::string& message) {
  return {ErrorCode::kRefused, std::string_view(message), std::string_view(text_of(path))};
}

Node scalar_node(std::string text) {
  Node node;
  node.kind = Node::Kind::kScalar;
  node.quoted = needs_quotes(text, true);
  node.text = std::move(text);
  return node;
}

Node* found(Node& root, const EditPath& path) {
  Node* node = &root;
  for (const std::string& part : path)
    if (node != nullptr) node = child_of(*node, part);
  return node;
}

Result<Node*> made(Node& root, const EditPath& path) {
  if (path.size() > kMaxNesting) return no_edit({path[0]}, "the path is too deep for a description");
  Node* node = &root;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const EditPath here(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    Node* child = child_of(*node, path[i]);
    if (child == nullptr) {
      const auto added = made_child(*node, here, i == 1 && path.size() > 2);
      if (!added) return added;
      child = *added;
    }
    node = child;
  }
  return node;
}

void insert_key(Node& map, std::size_t at, std::string key, Node value) {
  const auto index = static_cast<std::ptrdiff_t>(at);
  map.keys.insert(map.keys.begin() + index, {std::move(key), {}});
  map.items.insert(map.items.begin() + index, std::move(value));
}

Result<void> check_new_name(const EditPath& path, const std::string& name) {
  Report report;
  if (check_name({name, {}}, "the name", report)) return {};
  return no_edit(path, report.faults()[0].message);
}

Result<void> link_port(Node& root, const LinkPort& link) {
  const EditPath path = {"tasks", link.task, "alias", link.port};
  for (const std::string& name : {link.port, link.variable})
    if (const auto legal = check_new_name(path, name); !legal) return legal;
  Node* task = found(root, {"tasks", link.task});
  if (task == nullptr) return made(root, path).error();
  Node* alias = found(root, path);
  if (!link.instance && link.variable == link.port) {
    if (alias == nullptr) return {};
    const bool is_last = found(root, {"tasks", link.task, "alias"})->items.size() == 1;
    return act(root, RemoveValue{is_last ? EditPath{"tasks", link.task, "alias"} : path});
  }
  EditPath place = path;
  if (link.instance) place.push_back(std::to_string(*link.instance));
  const auto value = made(root, place);
  if (!value) return value.error();
  graft(**value, scalar_node(link.variable));
  return {};
}

Result<void> act_on(Node& root, const EditAct& one) {
  const EditPath task = {"tasks", kSequenceTask};
  const bool is_of_key = found(root, {kSequenceTask}) != nullptr && found(root, task) == nullptr;
  const Result<void> done = std::visit([&root](const auto& what) { return act(root, what); }, one);
  if (!is_of_key) return done;
  const bool fails_at_it = !done && (std::string(done.error().where.view()) + '/').starts_with(text_of(task) + '/');
  if (!fails_at_it && found(root, task) == nullptr) return done;
  return no_edit(task, "task 'sequence' comes from the key 'sequence': edit its steps");
}

}  // namespace chimera
