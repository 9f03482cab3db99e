// SPDX-License-Identifier: Apache-2.0
// The rows that the commands of the shell print. docs/formats/serial.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/runtime/life/task_set.h"
#include "firmware/shell/recent_events.h"
#include "firmware/shell/text_line.h"
#include "firmware/watch/reset_record.h"

// Context of everything: between jobs; wait-free.
namespace chimera::firmware {

/// The first row of `status`; `now` counts from the start of the run. O(tasks).
void put_head(TextLine& line, TaskSet& set, Nanoseconds now) noexcept;
/// The row of a task in `status`.
void put_task(TextLine& line, const Task& task) noexcept;
/// Rows of `profile`, by number from 0. False: there are no more.
bool put_profile(TextLine& line, const Task& task, std::size_t row, Nanoseconds origin) noexcept;
/// "aborted, on-failed, task spare": the end of a switch, and why.
void put_end(TextLine& line, SwitchEnd end, NoSwitch why, TaskId task, const ApplicationSpec& spec) noexcept;
/// The row of an event.
void put_event(TextLine& line, const ShellEvent& event, const ApplicationSpec& spec, Nanoseconds origin) noexcept;
/// An element of a value. Requires: no struct.
void put_element(TextLine& line, std::uint32_t type, std::uint32_t bytes, const std::byte* at) noexcept;
/// " m/s"; nothing for "1" and "".
void put_unit(TextLine& line, std::string_view unit) noexcept;

/// "healthy", "silent: control", "stack guard: stack 1". A task beyond `tasks` appears as its number.
void put_vital(TextLine& line, const VitalAnswer& answer, std::span<const TaskSpec> tasks) noexcept;
/// "warm boot 2: watchdog in cycle of task control at 0x00001234, silent: control"; "cold boot" after power came on.
/// A task beyond `tasks` appears as its number.
void put_boot(TextLine& line, const Boot& boot, std::span<const TaskSpec> tasks) noexcept;

}  // namespace chimera::firmware
