// SPDX-License-Identifier: Apache-2.0
// Puts into words at which step of making a task a process died.
#include "chimera/runtime/hosted/making_text.h"

#include "chimera/runtime/making.h"

namespace chimera {

std::string making_text(std::uint32_t word, std::string_view task, std::string_view object) {
  const bool loads = TaskWord::found(word).what() == static_cast<std::uint32_t>(Making::kLoads);
  return std::string(loads ? "while it loaded " : "while it constructed a state of ") + std::string(object) +
         ", the component of task '" + std::string(task) + "'";
}

}  // namespace chimera
