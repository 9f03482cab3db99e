// SPDX-License-Identifier: Apache-2.0
// Texts and numbers as JSON writes them.
#pragma once

#include <string>
#include <string_view>

namespace chimera {

/// `text` as a JSON string with its quotes, in which nothing steers a terminal (plain_json());
/// what is no UTF-8 becomes the replacement character. Context: setup.
std::string json_string(std::string_view text);
/// A finite number as JSON, in the shortest form that reads back the same; null for what JSON has no number for.
std::string json_number(double value);

}  // namespace chimera
