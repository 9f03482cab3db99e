// SPDX-License-Identifier: Apache-2.0
// Reading answers: a key that is missing, null or of another kind is the plain default, so that a face of one version
// shows what it can of an answer of another.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chimera::cli {

/// The member `key` of an object; a null for whatever is not there. Context of all: setup.
const nlohmann::json& field(const nlohmann::json& object, std::string_view key);
std::string text_of(const nlohmann::json& object, std::string_view key);
std::int64_t whole_of(const nlohmann::json& object, std::string_view key);
std::optional<std::int64_t> whole_or_none(const nlohmann::json& object, std::string_view key);
double number_of(const nlohmann::json& object, std::string_view key);
bool truth_of(const nlohmann::json& object, std::string_view key);
/// Every text of the array `key`.
std::vector<std::string> texts_of(const nlohmann::json& object, std::string_view key);

}  // namespace chimera::cli
