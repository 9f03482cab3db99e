// SPDX-License-Identifier: Apache-2.0
// One function for each kind of act.
#include "chimera/description/edit_json.h"

namespace chimera {
namespace {

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

Json json_of(const AddTask& add) { return {{"act", "add_task"}, {"name", add.name}, {"component", add.component}}; }

Json json_of(const LinkPort& link) {
  return {{"act", "link"},
          {"task", link.task},
          {"port", link.port},
          {"variable", link.variable},
          {"instance", link.instance ? Json(*link.instance) : Json()}};
}

Json json_of(const JoinProducers& join) {
  constexpr const char* kBy[] = {"mean", "priority", "select"};
  return {{"act", "join"},
          {"variable", join.variable},
          {"by", kBy[static_cast<std::size_t>(join.by)]},
          {"producers", ports_json(join.producers)}};
}

}  // namespace

Json edit_json(const EditAct& act) {
  return std::visit([](const auto& each) { return json_of(each); }, act);
}

}  // namespace chimera
