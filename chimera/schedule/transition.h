// SPDX-License-Identifier: Apache-2.0
// Proves that every job meets its deadline while one set of tasks replaces another. A proof for each set alone is not
// enough: jobs of leaving tasks, released before the change, meet jobs of arriving tasks. Sets of 50 % each may already
// be too much under earliest deadline; for fixed priorities see Real & Crespo, Real-Time Systems 26(2), 2004.
//
// Assumptions beyond work.h: grids of releases are fixed, at multiples of the period plus the offset from one origin.
// The change T is any instant. A leaving task releases on its grid before T, an arriving task at T or later; a staying
// task continues on its grid. A job that was released before T runs to its end.
//
// The sufficient test, for every length x of the part of a busy window before T. x runs from 0 (the set after, with the
// rest of the set before) to the length of the window (the set before):
//   earliest deadline   due(t, x) + blocking(t, x) + requests of earlier levels(s, x) <= s for some s <= t, for all t:
//                       the demand of analysis.h (Baruah, Rosier, Howell 1990) over the jobs that a window with T at
//                       x can contain (change_window.h). Each criticality of `muf` is such a level
//   fixed priority,     f - y <= D for all jobs of the window, released at y and done at the least f that holds them
//   preemptive          and all requests of higher priorities, leaving ones before x, arriving ones from x on: response
//                       times with the requests of both modes (Joseph & Pandya 1986; Tindell, Burns, Wellings, RTSS
//                       1992)
//   fixed priority,     the same over all jobs of the busy period behind the longest later job (George, Rivierre, Spuri
//   executive           1996), which is one of an arriving task only where x = 0
//   least laxity        the demand above and (n - 1) quanta, n counting tasks of both sets
// A task that is replaced like for like (same period, offset, deadline, rank and rtpu) counts, in a first attempt, as
// one staying task with the longer time: its jobs do no more than a task of that time. So a switch that only replaces
// like for like, by times that are not longer, is schedulable if the set before is. Servers count as present before and
// after.
//
// The test excludes `on` of arriving and `off` of leaving tasks; an executive runs them in gaps that they fit into.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/analysis.h"
#include "chimera/schedule/change_window.h"

namespace chimera {

struct TransitionVerdict {
  Guarantee guarantee = Guarantee::kYes;  ///< kYes: all tasks with a time meet their deadlines before, at and after T
  std::uint32_t task = 0;                 ///< for kNo and kTooLong: a task without a guarantee
  Nanoseconds settled;      ///< this long after T all jobs released before T have ended; kNever: no bound
  std::uint32_t unstated = 0;  ///< tasks without a time, counted as zero
  std::int64_t terms = 0;      ///< cost of the searches: number of added terms
};

/// Judges the tasks of `works` that run on `cpu` over the transition; works[i] has the part `parts[i]`. `verdicts` is
/// as long as `works`; only entries of this CPU that take part are written. Their guarantee and longest response hold
/// for all jobs before, at and after T. `room` needs one element for each of these tasks. Requires: the conditions of
/// Work and ProcessorUse. Context: setup; pure; gives up (kTooLong) after 20 million terms.
TransitionVerdict analyse_transition(std::span<const Work> works, std::span<const TransitionPart> parts,
                                     std::span<const ProcessorUse> uses, std::uint32_t cpu,
                                     std::span<WorkVerdict> verdicts, std::span<MovingWork> room) noexcept;

}  // namespace chimera
