// SPDX-License-Identifier: Apache-2.0
// Writes what a failed `off` or `kill` means for the device behind a task.
#include "chimera/text/not_off.h"

namespace chimera {

std::string not_off_text(Method method, std::string_view fault) {
  const std::string left = method == Method::kKill ? " or released" : "";
  return std::string(method_name(method)) + " failed: " + std::string(fault) + ": its hardware may not be off" + left;
}

std::string not_off_text(std::string_view cause) { return std::string(cause) + ": its hardware may not be off"; }

}  // namespace chimera
