// SPDX-License-Identifier: Apache-2.0
// Checks that the shared objects of a legal description can be components, without running their code.
#include <algorithm>
#include <set>

#include "chimera/catalogue/library.h"
#include "chimera/load/shared_object.h"
#include "chimera/verify/verify.h"

namespace chimera {

Report faulty_objects(const Configuration& configuration, const Library& library) {
  Report report(configuration.file(), configuration.draft().keys);
  std::set<std::string> seen;
  for (const ConfiguredTask& task : configuration.tasks()) {
    const LibraryEntry* entry = library.find(task.component);
    if (entry == nullptr || entry->object_file.empty() || !seen.insert(task.component).second) continue;
    for (const HiddenComponent& hidden : library.hidden())
      if (hidden.name == task.component)
        report.note("component '" + task.component + "' is that of " + entry->descriptor_file +
                    ", which CHIMERA_PATH names before " + hidden.file);
    const auto sound = SharedObject::inspect(entry->object_file, task.component);
    if (sound) continue;
    const auto& drafts = configuration.draft().tasks;
    const auto draft = std::ranges::find_if(drafts, [&](const DraftTask& d) { return d.name.text == task.name; });
    const std::string_view why = sound.error().message.view();
    const bool has_remedy = why.ends_with(kRebuild);
    report.add({.rule = "component-object",
                .at = draft == drafts.end() ? task.at : draft->component.at,
                .message = "task '" + task.name +
                           "': " + std::string(why.substr(0, why.size() - (has_remedy ? kRebuild.size() : 0))),
                .found = entry->object_file,
                .expected = "the shared object of '" + task.component + "'",
                .remedy = "rebuild the component: " + entry->object_file + " is what would be loaded"});
  }
  report.sort();
  return report;
}

}  // namespace chimera
