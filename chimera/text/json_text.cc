// SPDX-License-Identifier: Apache-2.0
// Writes JSON so that nothing in it steers a terminal.
#include "chimera/text/json_text.h"

#include "chimera/base/hosted/terminal_text.h"

namespace chimera {

std::string json_string(std::string_view text) { return plain_json(Json(text).dump()); }

std::string spaced_json(const Json& json) { return plain_json(json.dump(Json::Style::kSpaced)); }

std::string json_number(double value) { return Json(value).dump(); }

}  // namespace chimera
