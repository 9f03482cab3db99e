// SPDX-License-Identifier: Apache-2.0
// The commands of the shell, and a line taken apart into its words. docs/formats/serial.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/base/fixed.h"

namespace chimera::firmware {

enum class Verb : std::uint8_t {
  kSpawn, kOn, kOff, kKill, kClear, kReinit, kSwitch, kGet, kSet, kProfile, kStatus, kEvents, kHelp
};

/// The kind of thing that the first operand names.
enum class Operand : std::uint8_t { kNone, kTask, kConfiguration, kVariable };

/// One command. Texts end with a zero, because an image has little flash.
struct CommandSpec {
  const char* name = nullptr;
  Verb verb = Verb::kHelp;
  Operand operand = Operand::kNone;
  std::uint8_t most = 0;  ///< operands; at least one where `operand` is not kNone, two for `set`
  const char* operands = "";
};

/// In the order in which `help` lists them. Context: any; wait-free.
std::span<const CommandSpec> commands() noexcept;

inline constexpr std::size_t kMostWords = 12;

/// Why a line is no command.
enum class LineFault : std::uint8_t { kNone, kUnknown, kTooManyWords, kTooFew, kTooMany };

/// The words of a line point into it.
struct CommandLine {
  const CommandSpec* command = nullptr;  ///< null: unknown, or no line
  LineFault fault = LineFault::kNone;
  FixedVector<std::string_view, kMostWords> words;  ///< the first is the command
  std::string_view after_first;  ///< behind the first operand, without blanks around it; for texts with blanks

  std::size_t n_operands() const noexcept { return words.size() - 1; }
  std::string_view operand(std::size_t i) const noexcept { return words.begin()[i + 1]; }
};

/// Requires: at most LineReader::kMost bytes. A line of blanks has no words and no fault. Context: any; wait-free.
CommandLine parse(std::string_view line) noexcept;

}  // namespace chimera::firmware
