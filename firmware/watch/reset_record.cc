// SPDX-License-Identifier: Apache-2.0
// Seals and judges the record with a mark and a sum.
#include "firmware/watch/reset_record.h"

namespace chimera::firmware {
namespace {

constexpr std::uint32_t kMark = 0xC41A0E01;  // of this layout
constexpr std::uint32_t kLastCause = static_cast<std::uint32_t>(ResetCause::kAssertion);
constexpr std::uint32_t kLastVital = static_cast<std::uint32_t>(VitalFault::kGuard);

// CRC-32 over the words: finds each change of up to 32 bits in a row, and of any three bits.
std::uint32_t sum_of(const ResetRecord& record) noexcept {
  std::uint32_t sum = ~0u;
  for (const std::uint32_t word :
       {record.mark, record.cause, record.running, record.pc, record.vital, record.warm_boots}) {
    sum ^= word;
    for (int bit = 0; bit < 32; ++bit) sum = (sum >> 1) ^ ((sum & 1) != 0 ? 0xEDB88320u : 0);
  }
  return ~sum;
}

void seal(ResetRecord& record) noexcept { record.sum = sum_of(record); }

/// A stray write may have hit the record: it begins anew then, and what it said is not sealed as true.
void make_whole(ResetRecord& record) noexcept {
  if (is_whole(record)) return;
  record = ResetRecord();
  record.mark = kMark;
}

}  // namespace

bool is_whole(const ResetRecord& record) noexcept {
  return record.mark == kMark && record.sum == sum_of(record) && record.cause <= kLastCause &&
         record.vital >> 16 <= kLastVital;
}

Boot take_up(ResetRecord& record) noexcept {
  Boot boot;
  if (is_whole(record)) {
    boot.is_warm = true;
    boot.warm_boots = record.warm_boots == UINT32_MAX ? UINT32_MAX : record.warm_boots + 1;
    boot.starts_off = boot.warm_boots >= kWarmBootsAllowed;
    boot.cause = static_cast<ResetCause>(record.cause);
    boot.running = {static_cast<std::uint16_t>(record.running >> 16), static_cast<std::uint16_t>(record.running)};
    boot.pc = record.pc;
    boot.vital = static_cast<VitalFault>(record.vital >> 16);
    boot.vital_number = record.vital & 0xFFFFu;
  }
  record = ResetRecord();
  record.mark = kMark;
  record.warm_boots = boot.warm_boots;
  seal(record);
  return boot;
}

void note_vital_fault(ResetRecord& record, const VitalAnswer& answer) noexcept {
  make_whole(record);
  const std::uint32_t number = answer.fault == VitalFault::kGuard ? answer.stack : answer.task.index;
  record.vital = static_cast<std::uint32_t>(answer.fault) << 16 | (number < 0xFFFFu ? number : 0xFFFFu);
  seal(record);
}

void forget_vital_fault(ResetRecord& record) noexcept {
  make_whole(record);
  record.vital = 0;
  seal(record);
}

void note_end(ResetRecord& record, ResetCause cause, RunningMethod running, std::uint32_t pc) noexcept {
  make_whole(record);
  if (record.cause != 0) return;
  record.cause = static_cast<std::uint32_t>(cause);
  record.running = std::uint32_t{running.task} << 16 | running.method;
  record.pc = pc;
  seal(record);
}

void note_settled(ResetRecord& record) noexcept {
  make_whole(record);
  record.warm_boots = 0;
  seal(record);
}

std::string_view cause_word(ResetCause cause) noexcept {
  switch (cause) {
    case ResetCause::kWatchdog: return "watchdog";
    case ResetCause::kFault: return "processor fault";
    case ResetCause::kStack: return "stack overflow";
    case ResetCause::kAssertion: return "assertion";
    default: return "no cause noted";
  }
}

}  // namespace chimera::firmware
