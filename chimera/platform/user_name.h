// SPDX-License-Identifier: Apache-2.0
// The names of the users of this machine.
#pragma once

#include <cstdint>
#include <string>

namespace chimera {

/// As /etc/passwd has it, else the number: no other directory of users is asked, which may be far away. Context: setup;
/// reads a local file.
std::string user_name(std::uint32_t user);

}  // namespace chimera
