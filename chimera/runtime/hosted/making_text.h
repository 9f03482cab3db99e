// SPDX-License-Identifier: Apache-2.0
// Describes in words at which step of making a task a process died.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "chimera/runtime/making.h"

namespace chimera {

/// Describes a word of show_making(): "while it loaded /lib/gain.so, the component of task 'amp'". Context: setup.
inline std::string making_text(std::uint32_t word, std::string_view task, std::string_view object) {
  const bool loads = TaskWord::found(word).what() == static_cast<std::uint32_t>(Making::kLoads);
  return std::string(loads ? "while it loaded " : "while it constructed a state of ") + std::string(object) +
         ", the component of task '" + std::string(task) + "'";
}

}  // namespace chimera
