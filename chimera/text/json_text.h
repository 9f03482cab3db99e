// SPDX-License-Identifier: Apache-2.0
// JSON as the commands print it.
#pragma once

#include <string>
#include <string_view>

#include "chimera/text/json.h"

namespace chimera {

/// `text` as a JSON string with its quotes, in which nothing steers a terminal (plain_json());
/// what is no UTF-8 becomes the replacement character. Context: setup.
std::string json_string(std::string_view text);
/// `json` with its keys as made and with spaces, on one line, in which nothing steers a terminal (plain_json()).
std::string spaced_json(const Json& json);
/// A finite number as JSON, in the shortest form that reads back the same; null for what JSON has no number for.
std::string json_number(double value);

}  // namespace chimera
