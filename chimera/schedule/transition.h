// SPDX-License-Identifier: Apache-2.0
// Does every job keep its deadline while one set of tasks takes the place of another? That each set does by itself is
// not enough: jobs of leaving tasks that were released before the change and jobs of arriving ones meet (modes of
// 50 % each may already be too much under earliest deadline; for fixed priorities see Real & Crespo, Real-Time Systems
// 26(2), 2004).
//
// What is assumed beyond work.h: grids of releases are fixed, multiples of the period plus the offset from one origin.
// The change T is any instant. A leaving task releases on its grid before T, an arriving one at T or after; a task that
// stays goes on on its grid; a job that was released before T is carried out to its end.
//
// What is sufficient, for every length x of the part of a busy window that lies before T, x = 0 (the set after, with
// what is left of the one before) to the length of the window (the set before):
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
// A task that is replaced like for like (same period, offset, deadline, rank and rtpu) is, in a first attempt, one task
// that stays, with the longer of both times: what its jobs do is what a task of that time may do. So a switch that only
// replaces like for like by no longer times is schedulable where the set before is. Servers count as if they were there
// before and after.
//
// Not part of it: `on` of arriving and `off` of leaving tasks, which an executive runs in gaps that they fit into.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/analysis.h"
#include "chimera/schedule/change_window.h"

namespace chimera {

struct TransitionVerdict {
  Guarantee guarantee = Guarantee::kYes;  ///< kYes: every task with a time keeps its deadlines, before, at and after T
  std::uint32_t task = 0;                 ///< of kNo and kTooLong: one that has no promise
  Nanoseconds settled;      ///< so long after T every job released before T has ended; kNever: no bound was found
  std::uint32_t unstated = 0;  ///< tasks without a time, counted as nothing
  std::int64_t terms = 0;      ///< what the searches cost, in terms added up
};

/// Judges the tasks of `works` that run on `cpu` over the transition in which works[i] takes part as `parts[i]`.
/// `verdicts` is as long as `works`, and only those of this CPU that take part are written: a promise there, and the
/// longest response, hold for all jobs before, at and after T. `room` needs as many elements as there are of these.
/// Requires: what Work and ProcessorUse say. Context: setup; pure; gives up (kTooLong) after 20 million terms.
TransitionVerdict analyse_transition(std::span<const Work> works, std::span<const TransitionPart> parts,
                                     std::span<const ProcessorUse> uses, std::uint32_t cpu,
                                     std::span<WorkVerdict> verdicts, std::span<MovingWork> room) noexcept;

}  // namespace chimera
