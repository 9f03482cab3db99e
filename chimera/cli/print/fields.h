// SPDX-License-Identifier: Apache-2.0
// Reads answers: a key that is missing, null or of another kind is the plain default. A client of one version so shows
// the known part of an answer of another version.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/text/json.h"

namespace chimera::cli {

/// Without what steers a terminal. Context of all: setup.
std::string text_of(const Json& object, std::string_view key);
std::int64_t whole_of(const Json& object, std::string_view key);
std::optional<std::int64_t> whole_or_none(const Json& object, std::string_view key);
double number_of(const Json& object, std::string_view key);
/// Every text of the array `key`.
std::vector<std::string> texts_of(const Json& object, std::string_view key);

}  // namespace chimera::cli
