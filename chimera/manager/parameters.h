// SPDX-License-Identifier: Apache-2.0
// Optional parameters of a call. What is there has the type that the row of the method asks for.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace chimera::manager {

/// Context of all: setup.
/// The texts under `key`; none when it is not there.
std::vector<std::string> texts(const nlohmann::json& parameters, const char* key);
/// The count under `key`, else `otherwise`.
std::uint64_t number(const nlohmann::json& parameters, const char* key, std::uint64_t otherwise);

}  // namespace chimera::manager
