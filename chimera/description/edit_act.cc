// SPDX-License-Identifier: Apache-2.0
// Reads and writes the path of an act.
#include "chimera/description/edit_act.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"

namespace chimera {

EditPath edit_path(std::string_view text) {
  EditPath path;
  while (!text.empty()) {
    const std::size_t slash = std::min(text.find('/'), text.size());
    path.emplace_back(text.substr(0, slash));
    text.remove_prefix(std::min(slash + 1, text.size()));
  }
  return path;
}

std::string text_of(const EditPath& path) { return join(path, "/"); }

}  // namespace chimera
