// SPDX-License-Identifier: Apache-2.0
// The cause of an rtpu's end, in words.
#pragma once

#include <string>

#include "chimera/rtpu/keeper_message.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/hosted/rtpu_block.h"

namespace chimera::manager {

/// "pid.cycle" for BlockHead::running and similar words; "" between jobs, and for a word that no rtpu would write.
/// Context: setup.
std::string running_text(const ApplicationSpec& spec, std::uint32_t running);

/// Why a job was given up that used too much (runtime/job/hang_rule.h), with the remedy: "used 5.2 ms, 1040 x its
/// budget of 5 us: raise budget, ...". Context: setup.
std::string overuse_text(const TaskSpec& task, Nanoseconds used);

/// "pid.off did not return within 2 s" of an rtpu that gave itself up, or "pid.cycle ended its thread"; "" for other
/// ends. Context: setup.
std::string hung_text(const ApplicationSpec& spec, const BlockHead& left);

/// "ended by signal 11 (SIGSEGV) in pid.cycle; core dumped", or "was ended: pid.off did not return within 2 s". `left`
/// is the block of the incarnation that ended; it is not there if that incarnation never made one. `made` names what
/// the rtpu was loading or constructing then ("while it loaded ..."). Context: setup.
std::string cause_text(const ApplicationSpec& spec, const KeeperMessage& ended, const BlockView& left,
                       const std::string& made = {});

}  // namespace chimera::manager
