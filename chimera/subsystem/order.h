// SPDX-License-Identifier: Apache-2.0
// The orders in which tasks are brought up and taken down, derived from the ports.
#pragma once

#include <vector>

#include "chimera/base/ids.h"
#include "chimera/runtime/application_spec.h"

namespace chimera::subsystem {

/// Every task once: the start set in its own order; around it hardware first, producers before their consumers, loops
/// cut at the first task by declaration. Turned ON forwards, OFF backwards.
std::vector<TaskId> data_flow_order(const ApplicationSpec& spec);

/// For each task the others that produce one of its in-consts.
std::vector<std::vector<TaskId>> makers_of_constants(const ApplicationSpec& spec);

}  // namespace chimera::subsystem
