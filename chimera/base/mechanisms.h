// SPDX-License-Identifier: Apache-2.0
// The mechanisms that an image has. A host has all of them. The image of a microcontroller has those that its
// application uses: the compiler is given -DCHIMERA_MECHANISMS='<mechanisms.h>', a header that `chimera bake` wrote
// with the same constants. Code asks with `if constexpr`; a linker that drops unused sections then leaves the rest out.
#pragma once

#ifdef CHIMERA_MECHANISMS
#include CHIMERA_MECHANISMS
#else
namespace chimera::mechanisms {

inline constexpr bool kPeers = true;       ///< other contexts: peers, shared memory, agreements among rtpus
inline constexpr bool kService = true;     ///< a service thread runs init and kill
inline constexpr bool kPreemptive = true;  ///< jobs preempt each other, each in a thread of its own
inline constexpr bool kServers = true;     ///< servers of aperiodic tasks
inline constexpr bool kStandbys = true;    ///< tasks that take over from others
inline constexpr bool kRestart = true;     ///< the reaction `restart` of on_fault
inline constexpr bool kTap = true;         ///< the trace
inline constexpr bool kBlame = true;       ///< the cause of a missed deadline
inline constexpr bool kSwitch = true;      ///< switches among configurations
inline constexpr bool kTransitions = true; ///< deadlines over a switch are judged while the program runs
inline constexpr bool kConstants = true;   ///< constants that tasks produce
inline constexpr bool kOperators = true;   ///< variables that an operator sets
inline constexpr bool kEvents = true;      ///< aperiodic tasks
inline constexpr bool kSafety = true;      ///< safety ports
inline constexpr bool kSignals = true;     ///< signals and requests that tasks send
inline constexpr bool kReactions = true;   ///< on_miss or on_overrun other than continue, tolerate, max_consecutive
inline constexpr bool kBudgets = true;     ///< budgets of execution time
inline constexpr bool kDigest = true;      ///< hashes of what is published
inline constexpr bool kStale = true;       ///< inputs that lose their validity with age
inline constexpr bool kVerified = false;   ///< bake verified everything: errors of setup need no words

}  // namespace chimera::mechanisms
#endif

namespace chimera::mechanisms {

/// Tasks read some groups through copies of their own, because the writer runs beside them.
inline constexpr bool kCopies = kPeers || kPreemptive;
/// A task may be created while another one that opens the same resource is not.
inline constexpr bool kRivals = kSwitch || kStandbys;
/// Components have work that a thread does beside their methods.
inline constexpr bool kBackground = kService;
/// Jobs wait outside the releases of their class: preempted, or released by an event.
inline constexpr bool kLooseJobs = kPreemptive || kEvents;
/// Tasks that failed are brought back.
inline constexpr bool kRecovery = kStandbys || kRestart;

}  // namespace chimera::mechanisms
