// SPDX-License-Identifier: Apache-2.0
// A chip and its board, as docs/formats/target.md describes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/description/draft.h"
#include "chimera/description/report.h"

namespace chimera::bake {

inline constexpr std::uint32_t kLastInterrupt = 479;       ///< of an ARMv7-M interrupt controller
inline constexpr std::int64_t kMostTickCycles = 1 << 24;   ///< SysTick has 24 bits
inline constexpr std::size_t kMostSafeWrites = 64;

/// A range of addresses. Address and size are multiples of 4.
struct MemoryRange {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  Place at;
};

struct NamedInterrupt {
  Word name;
  std::uint32_t number = 0;
};

struct NamedPin {
  Word name;
  std::uint32_t address = 0;
  std::uint32_t bit = 0;
  bool is_output = false;
};

struct SafeWrite {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};

struct SerialLine {
  std::uint32_t address = 0;
  Word interrupt;
  std::uint32_t baud = 0;
};

/// The texts of the instances of one resource port; a port that is not repeated has one.
struct ResourceTexts {
  Word task, port;
  std::vector<Word> texts;
  bool is_list = false;
};

struct EventLine {
  Word task, interrupt;
};

/// Plain value.
struct Target {
  std::string name;  ///< of the file, without folder and extension
  std::string cpu, board;
  std::uint32_t clock_hz = 0;
  Located<Nanoseconds> tick{milliseconds(1), {}};
  MemoryRange flash, ram;
  std::uint32_t stack_bytes = 2048, handler_stack_bytes = 1024;
  std::optional<SerialLine> uart;
  bool shell = true;     ///< on `uart`, if nothing else has it
  Nanoseconds watchdog;  ///< 0: none
  std::vector<NamedInterrupt> interrupts;
  std::vector<NamedPin> pins;
  std::vector<SafeWrite> safe_writes;
  std::vector<ResourceTexts> resources;
  std::vector<EventLine> events;

  /// The number of the interrupt of that name; nullopt: there is none.
  std::optional<std::uint32_t> interrupt(std::string_view interrupt_name) const;
  bool has_pin(std::string_view pin_name) const;
  /// The texts for that port of the task; nullptr: the target has none.
  const ResourceTexts* resource(std::string_view task, std::string_view port) const;
  /// The first resource port `device` with the text 'uart': its task has the serial line; nullptr: there is none.
  const ResourceTexts* user_of_uart() const;
  /// A person can give commands, if the image has no link.
  bool has_shell() const { return shell && uart && user_of_uart() == nullptr; }
};

/// The text of a resource port of this name is a line of the target: `pin`, `interrupt`, `device`. Context: any.
bool is_of_board(std::string_view port) noexcept;

/// The text of the target of that name, for `like`; nullopt: there is none. `file` gets its name for messages.
using FindTarget = std::function<std::optional<std::string>(const std::string& name, std::string& file)>;

/// A target, if the text can be read and has no fault, and all faults of the text.
struct ReadTarget {
  std::optional<Target> target;
  Report report;
};

/// Reads `text`; messages call it `file`. Refuses unknown keys, values and names, each with its place and a remedy. A
/// fault of the target behind `like` is reported at its key. Context: setup.
ReadTarget read_target(std::string_view text, std::string_view file, const FindTarget& find);

}  // namespace chimera::bake
