// SPDX-License-Identifier: Apache-2.0
// How old may what a sensor saw be while an actuator still acts on it? Along a chain of periodic tasks, each of which
// reads the latest publication of the one before:
//   every link     T + R of the producer: its next job comes within T and is published within R (Davare et al., DAC
//                  2007; as a bound of the maximum data age: Duerr et al., ACM TECS 18(5s), 2019)
//   a tighter one  when the producer always goes before the consumer on its rtpu, all its jobs released so far are
//                  published when the consumer reads: only T; and 0 when every release of the consumer is also one of
//                  the producer
//   the last task  T + R: it ends within R, and what it wrote stands until its next job ends
// From the release of the sensor's job until the actuator's output is replaced.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/work.h"

namespace chimera {

/// One task of a chain.
struct ChainLink {
  Work work;
  Nanoseconds response = kNever;  ///< at most; kNever: without bound
  bool goes_before_next = false;  ///< goes_always_before(this, next)
};

/// Whether at every instant at which jobs of both wait `a` goes first, `a` having been released no later: `a_index` and
/// `b_index` are their places in the description. Only tasks of one rtpu. Context: setup; pure.
bool goes_always_before(const Work& a, std::uint32_t a_index, const Work& b, std::uint32_t b_index,
                        const ProcessorUse& use) noexcept;

/// The longest age; kNever when some task has no bound. Requires: not empty. Context: setup; pure.
Nanoseconds worst_data_age(std::span<const ChainLink> chain) noexcept;

}  // namespace chimera
