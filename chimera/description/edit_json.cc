// SPDX-License-Identifier: Apache-2.0
// One function for each kind of act and each direction.
#include "chimera/description/edit_json.h"

#include <algorithm>
#include <iterator>

#include "chimera/base/hosted/wording.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

constexpr const char* kBy[] = {"mean", "priority", "select"};

Json ports_json(const std::vector<TaskPort>& ports) {
  Json all = Json::array();
  for (const TaskPort& each : ports) all.push_back({{"task", each.task}, {"port", each.port}});
  return all;
}

Json json_of(const SetValue& set) { return {{"act", "set"}, {"path", text_of(set.path)}, {"value", set.value}}; }

Json json_of(const RemoveValue& remove) { return {{"act", "remove"}, {"path", text_of(remove.path)}}; }

Json json_of(const RenameKey& rename) {
  return {{"act", "rename"}, {"path", text_of(rename.path)}, {"to", rename.to}, {"ports", ports_json(rename.ports)}};
}

Json json_of(const AddTask& add) {
  Json act = {{"act", "add_task"}, {"name", add.name}, {"component", add.component}};
  if (add.subsystem != AddTask{}.subsystem) act["subsystem"] = add.subsystem;
  return act;
}

Json json_of(const LinkPort& link) {
  return {{"act", "link"},
          {"task", link.task},
          {"port", link.port},
          {"variable", link.variable},
          {"instance", link.instance ? Json(*link.instance) : Json()}};
}

Json json_of(const JoinProducers& join) {
  return {{"act", "join"},
          {"variable", join.variable},
          {"by", kBy[static_cast<std::size_t>(join.by)]},
          {"producers", ports_json(join.producers)}};
}

/// Reads the keys of one object, and keeps its first fault.
class KeyReader {
 public:
  KeyReader(const Json& object, std::string place, std::optional<Error>& fault)
      : object_(object), place_(std::move(place)), fault_(fault) {
    if (!object.is_object()) refuse("", "expected an object");
  }

  std::string text(const char* key, const char* otherwise = nullptr) {
    const Json* value = find(key);
    if (value == nullptr && otherwise != nullptr) return otherwise;
    if (value == nullptr) refuse(key, "there is no " + in_quotes(key));
    else if (!value->is_string()) refuse(key, "expected a text");
    else return value->as_string();
    return {};
  }

  /// Number of the word in `words`.
  std::size_t word(const char* key, std::span<const char* const> words) {
    const std::string written = text(key);
    const auto at = std::ranges::find(words, written) - words.begin();
    if (at < std::ssize(words)) return static_cast<std::size_t>(at);
    refuse(key, "expected " + join(words, ", ", {}, " or "));
    return 0;
  }

  std::optional<std::size_t> count_or_null(const char* key) {
    const Json* value = find(key);
    if (value == nullptr || value->is_null()) return std::nullopt;
    if (value->is_whole() && value->as_int64() >= 0) return value->as_uint64();
    refuse(key, "expected null or a whole number from 0 on");
    return std::nullopt;
  }

  std::vector<TaskPort> ports(const char* key, bool& is_missing) {
    const Json* all = find(key);
    std::vector<TaskPort> ports;
    is_missing = all == nullptr;
    if (all != nullptr && !all->is_array()) refuse(key, "expected an array");
    for (std::size_t i = 0; all != nullptr && i < all->size(); ++i) {
      KeyReader each((*all)[i], place_ + "/" + key + "/" + std::to_string(i), fault_);
      ports.push_back({each.text("task"), each.text("port")});
      each.refuse_others();
    }
    return ports;
  }

  /// Call it after all keys have been read.
  void refuse_others() {
    for (const auto& [key, value] : object_.items())
      if (std::ranges::find(known_, key) == known_.end())
        refuse(key.substr(0, 40), no_such("key", key.substr(0, 40), known_));
  }

  void refuse(const std::string& key, const std::string& message) {
    if (!fault_) fault_ = Error{ErrorCode::kBadInput, {message}, {place_ + (key.empty() ? "" : "/" + key)}};
  }

 private:
  const Json* find(const char* key) {
    known_.emplace_back(key);
    return object_.find(key);
  }

  const Json& object_;
  std::string place_;
  std::optional<Error>& fault_;
  std::vector<std::string> known_;
};

EditPath path_in(KeyReader& keys) { return edit_path(keys.text("path")); }

EditAct set_in(KeyReader& keys) {
  SetValue act{path_in(keys), {}};
  act.value = keys.text("value");
  return act;
}

EditAct remove_in(KeyReader& keys) { return RemoveValue{path_in(keys)}; }

EditAct rename_in(KeyReader& keys) {
  RenameKey act{path_in(keys), {}, {}};
  act.to = keys.text("to");
  act.ports = keys.ports("ports", act.lacks_ports);
  return act;
}

EditAct add_task_in(KeyReader& keys) {
  AddTask act{keys.text("name"), {}};
  act.component = keys.text("component");
  act.subsystem = keys.text("subsystem", act.subsystem.c_str());
  return act;
}

EditAct link_in(KeyReader& keys) {
  LinkPort act{keys.text("task"), {}, {}, {}};
  act.port = keys.text("port");
  act.variable = keys.text("variable");
  act.instance = keys.count_or_null("instance");
  return act;
}

EditAct join_in(KeyReader& keys) {
  JoinProducers act{keys.text("variable"), {}, {}};
  act.by = static_cast<JoinBy>(keys.word("by", kBy));
  act.producers = keys.ports("producers", act.lacks_ports);
  return act;
}

EditAct act_in(KeyReader& keys) {
  constexpr const char* kActs[] = {"set", "remove", "rename", "add_task", "link", "join"};
  constexpr EditAct (*kReadAct[])(KeyReader&) = {set_in, remove_in, rename_in, add_task_in, link_in, join_in};
  return kReadAct[keys.word("act", kActs)](keys);
}

}  // namespace

Json edit_json(const EditAct& act) {
  return std::visit([](const auto& each) { return json_of(each); }, act);
}

Json edits_json(std::span<const EditAct> acts) {
  Json all = Json::array();
  for (const EditAct& act : acts) all.push_back(edit_json(act));
  return all;
}

Result<std::vector<EditAct>> edit_acts(const Json& acts) {
  if (!acts.is_array()) return Error{ErrorCode::kBadInput, {"expected an array of acts"}, {"acts"}};
  std::vector<EditAct> all;
  std::optional<Error> fault;
  for (std::size_t i = 0; i < acts.size() && !fault; ++i) {
    KeyReader keys(acts[i], "acts/" + std::to_string(i), fault);
    all.push_back(act_in(keys));
    keys.refuse_others();
  }
  if (fault) return *fault;
  return all;
}

}  // namespace chimera
