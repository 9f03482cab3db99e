// SPDX-License-Identifier: Apache-2.0
// What the image knows about itself when it fails, and the record of it that outlives the reset.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/watch/reset_record.h"

namespace chimera::firmware {

/// TaskWord of the job that runs, and of the method that runs at a cycle boundary; 0: none. Relaxed, because only the
/// handler of a failure reads them.
inline constinit std::atomic<std::uint32_t> job_word{0}, boundary_word{0};

/// The record, in memory that neither start-up nor a reset clears (image.ld). Context: any.
ResetRecord& reset_record() noexcept;
/// The method that runs now. Context: any; wait-free.
RunningMethod running_method() noexcept;

}  // namespace chimera::firmware
