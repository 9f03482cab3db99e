// SPDX-License-Identifier: Apache-2.0
// The record lies at the begin of the RAM.
#include "firmware/boot/kept.h"

#include "chimera/runtime/task_word.h"

extern "C" chimera::firmware::ResetRecord image_reset_record;
static_assert(sizeof(chimera::firmware::ResetRecord) <= 32, "image.ld leaves 32 bytes for it");

namespace chimera::firmware {

ResetRecord& reset_record() noexcept { return image_reset_record; }

RunningMethod running_method() noexcept {
  TaskWord word = TaskWord::found(boundary_word.load(std::memory_order_relaxed));
  if (!word.has_method()) word = TaskWord::found(job_word.load(std::memory_order_relaxed));
  if (!word.has_method()) return {};
  return {static_cast<std::uint16_t>(word.task().index), static_cast<std::uint16_t>(word.method())};
}

}  // namespace chimera::firmware
