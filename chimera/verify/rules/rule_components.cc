// SPDX-License-Identifier: Apache-2.0
// Rules on components: each is known, built, and of a kind that can be run.
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

void refuse_unbuilt(Model& model, const DraftTask& task) {
  const std::string& name = task.component.text;
  model.error("component-unknown", task.component.at,
              "task '" + task.name.text + "': the component '" + name + "' is not built: only its source is here", name,
              "a component that is built", "", "'./dev install' in the checkout builds and installs the whole library");
}

void refuse_streams(Model& model, const TaskModel& task) {
  for (const PortDescriptor& port : task.component->ports)
    if (port.kind == CHIMERA_IN_STREAM || port.kind == CHIMERA_OUT_STREAM)
      model.error("port-stream", task.draft->component.at,
                  "task '" + task.name() + "': port '" + port.name + "' of component '" + task.component->name +
                      "' is a stream; streams are not built yet",
                  port.name, "a component without streams");
}

/// Why the file that should describe the component is not in the library; nullptr: there is none.
const Error* fault_of(const Model& model, const std::string& component) {
  for (const Error& fault : model.library.faults())
    if (fault.where.view().ends_with("/" + component + ".component.json")) return &fault;
  return nullptr;
}

void refuse_unknown(Model& model, const DraftTask& task) {
  const std::string& name = task.component.text;
  const std::string component = "task '" + task.name.text + "': the component '" + name + "' ";
  if (const Error* fault = fault_of(model, name)) {
    const std::string why = std::string(fault->where.view()) + ": " + std::string(fault->message.view());
    model.error("component-unknown", task.component.at, component + "cannot be used: " + why, name,
                "a component whose descriptor can be read", {}, "rebuild the component " + name);
    return;
  }
  const std::string near = model.library.nearest_name(name);
  std::string remedy = "'chimera list' shows the library; CHIMERA_PATH adds folders to it";
  for (const std::string& folder : model.library.missing_folders())
    remedy += "; CHIMERA_PATH names " + folder + ", which is no folder";
  model.error("component-unknown", task.component.at, component + "is not in the library", name,
              "a component of the library", near, near.empty() ? remedy : "");
}

}  // namespace

void find_components(Model& model) {
  for (const DraftTask& draft : model.draft.tasks) {
    TaskModel task;
    task.draft = &draft;
    const LibraryEntry* entry = draft.component.empty() ? nullptr : model.library.find(draft.component.text);
    if (entry != nullptr) {
      task.component = &entry->descriptor;
      refuse_streams(model, task);
    } else if (model.library.is_unbuilt(draft.component.text)) {
      refuse_unbuilt(model, draft);
    } else if (!draft.component.empty()) {
      refuse_unknown(model, draft);
    }
    model.tasks.push_back(std::move(task));
  }
}

}  // namespace chimera
