// SPDX-License-Identifier: Apache-2.0
#include "chimera/config/rules.h"

namespace chimera {
namespace {

void refuse_streams(Model& model, const TaskModel& task) {
  for (const PortDescriptor& port : task.component->ports)
    if (port.kind == CHIMERA_IN_STREAM || port.kind == CHIMERA_OUT_STREAM)
      model.error("port-stream", task.draft->component.at,
                  "task '" + task.name() + "': port '" + port.name + "' of component '" + task.component->name +
                      "' is a stream; streams are not built yet",
                  port.name, "a component without streams");
}

}  // namespace

/// Why the file that should describe the component is not in the library; empty: there is none.
std::string fault_of(const Model& model, const std::string& component) {
  for (const Error& fault : model.library.faults())
    if (fault.where.view().ends_with("/" + component + ".component.json"))
      return "; " + std::string(fault.where.view()) + ": " + std::string(fault.message.view());
  return "";
}

void find_components(Model& model) {
  for (const DraftTask& draft : model.draft.tasks) {
    TaskModel task;
    task.draft = &draft;
    const LibraryEntry* entry = draft.component.empty() ? nullptr : model.library.find(draft.component.text);
    if (entry != nullptr) {
      task.component = &entry->descriptor;
      refuse_streams(model, task);
    } else if (!draft.component.empty()) {
      const std::string near = model.library.nearest_name(draft.component.text);
      model.error("component-unknown", draft.component.at,
                  "task '" + task.name() + "': the component '" + draft.component.text + "' is not in the library" +
                      fault_of(model, draft.component.text),
                  draft.component.text, "a component of the library", near,
                  near.empty() ? "'chimera list' shows the library; CHIMERA_PATH adds folders to it" : "");
    }
    model.tasks.push_back(std::move(task));
  }
}

}  // namespace chimera
