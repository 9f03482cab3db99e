// SPDX-License-Identifier: Apache-2.0
// Reads optional parameters out of a JSON object.
#include "chimera/manager/parameters.h"

#include <nlohmann/json.hpp>

namespace chimera::manager {

std::vector<std::string> texts(const nlohmann::json& parameters, const char* key) {
  const auto found = parameters.find(key);
  return found == parameters.end() ? std::vector<std::string>() : found->get<std::vector<std::string>>();
}

std::uint64_t number(const nlohmann::json& parameters, const char* key, std::uint64_t otherwise) {
  const auto found = parameters.find(key);
  return found == parameters.end() ? otherwise : found->get<std::uint64_t>();
}

}  // namespace chimera::manager
