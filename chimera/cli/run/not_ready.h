// SPDX-License-Identifier: Apache-2.0
// Who holds up the start of a subsystem, as far as it is known.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace chimera::cli {

/// "log (csv_log): its `init` is under way", from the answer of `status`; a sentence also when nobody stands out.
/// Context: setup.
std::string not_ready(const nlohmann::json& status);

}  // namespace chimera::cli
