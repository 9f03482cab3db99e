// SPDX-License-Identifier: Apache-2.0
// Lists components and prints the data sheet of one.
#include "chimera/cli/files/list.h"

#include <algorithm>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/catalogue/descriptor_json.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/cli/files/data_sheet.h"

namespace chimera::cli {
CommandResult list(const Workplace& workplace, bool json) {
  const auto library = workplace.library();
  if (!library) return file_refusal(library.error(), json);
  CommandResult output;
  std::size_t width = 4;
  for (const LibraryEntry& entry : library->entries()) width = std::max(width, entry.descriptor.name.size());
  Json components = Json::array();
  for (const LibraryEntry& entry : library->entries()) {
    const Descriptor& d = entry.descriptor;
    output.out += padded(d.name, width) + "  " + plain_line(d.doc) + "\n";
    components.push_back({{"name", d.name}, {"doc", d.doc}, {"file", entry.object_file}});
  }
  if (json)
    output.out = spaced_json({{"components", std::move(components)}}) + "\n";
  else if (library->entries().empty())
    output.err = "no components found; CHIMERA_PATH says where to look\n";
  for (const std::string& folder : library->missing_folders())
    output.err += "warning: CHIMERA_PATH names " + folder + "\n";
  for (const Error& fault : library->faults()) output.err += error_line(fault);
  if (!library->faults().empty() && !json) output.err += "rebuild the components that cannot be read\n";
  if (!library->faults().empty()) output.code = kRefused;
  if (const std::size_t n = library->n_unbuilt(); n > 0 && !json)
    output.err += std::to_string(n) + " more have their source here and are not built: './dev install' builds all\n";
  return output;
}

CommandResult describe_component(const std::string& name, const Workplace& workplace, bool json) {
  const auto library = workplace.library();
  if (!library) return file_refusal(library.error(), json);
  const LibraryEntry* entry = library->find(name);
  if (entry == nullptr) return file_refusal(no_component(name, *library), json);
  CommandResult output;
  output.out = json ? to_json(entry->descriptor) : data_sheet(*entry);
  return output;
}

}  // namespace chimera::cli
