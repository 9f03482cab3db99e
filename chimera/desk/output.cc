// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/output.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace chimera::desk {

std::string error_line(const Error& error) {
  std::string text(error.where.view());
  text += text.empty() ? "error: " : ": error: ";
  text += error.message.view();
  return text + "\n";
}

Output refused(const Error& error, bool json, int code) {
  Output output;
  output.code = code;
  if (json)
    output.out = "{\"error\": {\"where\": " + json_string(error.where.view()) +
                 ", \"message\": " + json_string(error.message.view()) + "}}\n";
  else
    output.err = error_line(error);
  return output;
}

std::string json_string(std::string_view text) {
  return nlohmann::json(std::string(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_number(double value) { return std::isfinite(value) ? nlohmann::json(value).dump() : "null"; }

}  // namespace chimera::desk
