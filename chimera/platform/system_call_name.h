// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace chimera {

/// "write"; "system call 437" for one that components seldom make. Context: any.
std::string system_call_name(std::uint64_t number);

}  // namespace chimera
