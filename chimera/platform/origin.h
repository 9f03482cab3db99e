// SPDX-License-Identifier: Apache-2.0
// Where a process comes from: a word in its environment that everything it starts inherits, unless somebody takes care
// to lose it. What components leave behind is known by it, by a user without any rights.
#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"

namespace chimera {

/// The variable of the environment that holds the word.
inline constexpr const char* kOriginVariable = "CHIMERA_ORIGIN";

/// The word of process `pid` as it was when its program began; "" when it has none or does not show it. Context: setup.
std::string origin_of(pid_t pid);

/// The name that process `pid` gave itself; "" when it is gone. Context: setup.
std::string name_of(pid_t pid);

/// The children of this process, ended ones too, where the kernel lists them (CONFIG_PROC_CHILDREN). One that comes or
/// goes meanwhile may be left out. Context: setup.
std::vector<pid_t> children_of_this_process();

/// SIGKILL for every process on this machine of that origin but the calling one, until none is found or `limit` is
/// over. False when some were found to the end. Context: setup; blocks.
bool end_all_from(std::string_view origin, Nanoseconds limit);

}  // namespace chimera
