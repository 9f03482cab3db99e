// SPDX-License-Identifier: Apache-2.0
// How a real-time unit ended, in words.
#pragma once

#include <string>

#include "chimera/rtpu/keeper_message.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/hosted/rtpu_block.h"

namespace chimera::manager {

/// "pid.cycle" for BlockHead::running and the like; "" between jobs, and for a word that no rtpu would write. Context:
/// setup.
std::string running_text(const ApplicationSpec& spec, std::uint32_t running);

/// "pid.off did not return within 2 s" of a unit that gave itself up, and "pid.cycle ended its thread"; "" when it did
/// not. Context: setup.
std::string hung_text(const ApplicationSpec& spec, const BlockHead& left);

/// "ended by signal 11 (SIGSEGV) in pid.cycle; core dumped", or "was ended: pid.off did not return within 2 s". `left`
/// is the block of the incarnation that ended; not there: it never showed one. `made` is what it loaded or constructed
/// then ("while it loaded ..."). Context: setup.
std::string cause_text(const ApplicationSpec& spec, const KeeperMessage& ended, const BlockView& left,
                       const std::string& made = {});

}  // namespace chimera::manager
