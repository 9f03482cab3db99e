// SPDX-License-Identifier: Apache-2.0
// Escapes strings for JSON and writes numbers so that they are read back exactly.
#include "chimera/text/json_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "chimera/base/hosted/terminal_text.h"

namespace chimera {

std::string json_string(std::string_view text) {
  return plain_json(nlohmann::json(std::string(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string json_number(double value) { return std::isfinite(value) ? nlohmann::json(value).dump() : "null"; }

}  // namespace chimera
