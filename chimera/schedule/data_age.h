// SPDX-License-Identifier: Apache-2.0
// Bounds the age of sensor data while an actuator still uses them. The chain consists of periodic tasks; each task
// reads the latest publication of the task before it:
//   every link     T + R of the producer: its next job comes within T and is published within R (Davare et al., DAC
//                  2007; as a bound of the maximum data age: Duerr et al., ACM TECS 18(5s), 2019)
//   a tighter one  only T if the producer always runs before the consumer on its rtpu, because all its released jobs
//                  are published when the consumer reads. 0 if each release of the consumer is also one of the producer
//   the last task  T + R: it ends within R, and its output stays until its next job ends
// The age runs from the release of the job of the sensor until the output of the actuator is replaced.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/work.h"

namespace chimera {

/// A task of a chain.
struct ChainLink {
  Work work;
  Nanoseconds response = kNever;  ///< upper bound; kNever: none
  bool goes_before_next = false;  ///< goes_always_before(this, next)
};

/// True if `a` runs first at each instant at which jobs of both wait and `a` was released no later. `a_index` and
/// `b_index` are their places in the set. Only for tasks of one rtpu. Context: setup; pure.
bool goes_always_before(const Work& a, std::uint32_t a_index, const Work& b, std::uint32_t b_index,
                        const ProcessorUse& use) noexcept;

/// The longest age; kNever if a task of the chain has no bound. Requires: not empty. Context: setup; pure.
Nanoseconds worst_data_age(std::span<const ChainLink> chain) noexcept;

}  // namespace chimera
