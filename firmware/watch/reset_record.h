// SPDX-License-Identifier: Apache-2.0
// A record of the last run for the next one, in memory that a reset does not clear.
//
//   boot       take_up()           whole: a warm boot, counted; else a new record
//   tick       note_vital_fault()  why the watchdog is not stroked any more
//   the end    note_end()          by the handler of the watchdog, of a processor fault or an assertion, before reset
//   boot       take_up()           returns what the run before noted, once
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/watch/vitals.h"

namespace chimera::firmware {

/// Why a run ended.
enum class ResetCause : std::uint32_t {
  kNone,       ///< not noted: power, the reset pin, a debugger
  kWatchdog,   ///< the watchdog was not stroked in time
  kFault,      ///< a fault of the processor, such as an access beyond the memory or a division by zero
  kStack,      ///< a stack grew into its guard
  kAssertion,  ///< CHIMERA_ASSERT
};

/// "watchdog" for kWatchdog. Context: any; wait-free.
std::string_view cause_word(ResetCause cause) noexcept;

/// Task and method that ran at the end. UINT16_MAX: none.
struct RunningMethod {
  std::uint16_t task = UINT16_MAX;
  std::uint16_t method = UINT16_MAX;  ///< as Method
};

/// Plain words; zeros or anything else after power came on. Only the functions below write it. Its owner puts it where
/// neither start-up nor a reset clears it.
struct ResetRecord {
  std::uint32_t mark = 0;
  std::uint32_t cause = 0;    ///< ResetCause
  std::uint32_t running = UINT32_MAX;  ///< task << 16 | method
  std::uint32_t pc = 0;       ///< of the instruction that was interrupted; 0: unknown
  std::uint32_t vital = 0;    ///< VitalFault << 16 | its task or stack: since when the watchdog is not stroked
  std::uint32_t warm_boots = 0;  ///< in a row
  std::uint32_t sum = 0;      ///< over the other words

  bool operator==(const ResetRecord&) const noexcept = default;
};

/// From this number of warm boots in a row on, the image starts no task.
inline constexpr std::uint32_t kWarmBootsAllowed = 3;

/// Result of take_up().
struct Boot {
  bool is_warm = false;             ///< the record was whole: the memory had power since the last run
  bool starts_off = false;          ///< warm_boots reached kWarmBootsAllowed: no task is started
  std::uint32_t warm_boots = 0;     ///< in a row, this one among them
  ResetCause cause = ResetCause::kNone;
  RunningMethod running;
  std::uint32_t pc = 0;
  VitalFault vital = VitalFault::kNone;
  std::uint32_t vital_number = 0;   ///< task or stack of `vital`
};

/// The record is one that a run has written, whole. Context: any; wait-free.
bool is_whole(const ResetRecord& record) noexcept;
/// Reads what the last run left, counts the boot, and empties the record: a second boot does not tell it again. Call it
/// once, before everything else that uses the record. Context: setup.
Boot take_up(ResetRecord& record) noexcept;
/// The watchdog is not stroked any more. Context: between jobs; wait-free.
void note_vital_fault(ResetRecord& record, const VitalAnswer& answer) noexcept;
/// The watchdog is stroked again. Context: between jobs; wait-free.
void forget_vital_fault(ResetRecord& record) noexcept;
/// The run ends. The first noted cause stays: later ones are its consequences. Context: any handler; wait-free.
void note_end(ResetRecord& record, ResetCause cause, RunningMethod running, std::uint32_t pc) noexcept;
/// This run has been healthy for long enough: the next warm boot is the first of its row. Context: between jobs.
void note_settled(ResetRecord& record) noexcept;

}  // namespace chimera::firmware
