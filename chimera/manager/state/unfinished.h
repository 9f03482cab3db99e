// SPDX-License-Identifier: Apache-2.0
// Tasks that an ended rtpu left without turning them off.
#pragma once

#include <string>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

struct Unfinished {
  TaskId task;
  std::string text;  ///< `not_off_text` (chimera/text/not_off.h)
};

/// Tasks in whose `off` or `kill` the rtpu died; when the run ends, also tasks that were still ON. `left` is the block
/// of the incarnation that ended, `cause` its `cause_text`. Context: setup.
std::vector<Unfinished> unfinished(const ManagerState& state, RtpuId rtpu, const BlockView& left,
                                   const std::string& cause);

}  // namespace chimera::manager
