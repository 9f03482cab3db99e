// SPDX-License-Identifier: Apache-2.0
// Escapes strings for JSON and writes numbers so that they are read back exactly.
#include "chimera/text/json_text.h"

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/text/json.h"

namespace chimera {

std::string json_string(std::string_view text) { return plain_json(Json(text).dump()); }

std::string json_number(double value) { return Json(value).dump(); }

}  // namespace chimera
