// SPDX-License-Identifier: Apache-2.0
// The commands of a person at a serial line: bytes in, bytes out, in short pieces of work between jobs.
// docs/formats/serial.md.
//
//   interrupt   receive()   -> ring -> step() -> reader -> words -> names -> act at a cycle boundary, or rows
//   interrupt   next_byte() <- ring <- step() <- one row
//
// A row goes out when all of it is in the ring, so that other lines of the image come between rows.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/platform/bare/byte_ring.h"
#include "chimera/platform/bare/serial_peer.h"
#include "chimera/runtime/cycle/releases.h"
#include "firmware/shell/command_line.h"
#include "firmware/shell/line_reader.h"
#include "firmware/shell/shell_listener.h"
#include "firmware/shell/text_line.h"
#include "firmware/shell/typed_value.h"
#include "firmware/watch/stack.h"
#include "firmware/watch/watchdog.h"

namespace chimera::firmware {

/// Everything that the shell shows and acts on; all of it outlives the shell.
struct ShellParts {
  TaskSet& set;
  Releases& releases;       ///< of the executor that runs with `listener`
  ShellListener& listener;
  std::span<const Stack> stacks;
  const Watchdog* watchdog = nullptr;  ///< null: there is none
  const Boot* boot = nullptr;          ///< how the image began; null: it is not known
};

/// A new line waits in the ring while one is worked on. No allocation.
class Shell final : public bare::SerialPeer {
 public:
  /// Context: setup.
  explicit Shell(const ShellParts& parts) noexcept : parts_(parts) {
    parts_.listener.follow(parts_.releases.receipts());
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  // For the interrupts of the serial line. Context: any, one at a time; wait-free.

  /// Bytes that do not fit are counted, and the line that they belong to is refused.
  bool receive(std::uint8_t byte) noexcept override;
  /// A byte of a row that is whole, or -1.
  int next_byte() noexcept override;

  // For the thread of the cycle boundaries, while no job is ready. Context: between jobs; wait-free.

  /// step() has something to do.
  bool has_work() const noexcept;
  /// Does one piece of work: reads up to 32 bytes, looks at up to 16 names or 128 words of a stack, makes at most one
  /// row, reads or shows one number, or sends up to 64 bytes. `now` is on the clock of the executor.
  void step(Nanoseconds now) noexcept;
  /// Bytes that receive() did not take. Those that the port lost while it was held are not among them.
  std::uint32_t lost_bytes() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  enum class Phase : std::uint8_t { kRead, kFind, kTyped, kAct, kSwitch, kRows, kAnswer };

  void send() noexcept;
  void read() noexcept;
  void begin_line() noexcept;
  bool refuse_line() noexcept;
  void find() noexcept;
  const std::string_view* name_at(std::size_t i) const noexcept;
  bool found(std::size_t i) noexcept;
  void begin_command() noexcept;
  bool is_given(std::uint32_t variable) const noexcept;
  /// The shape of the value that the operator gives, or else `port`; 0 bytes: there is neither.
  ValueShape shape_of(std::uint32_t variable, const PortSpec* port) const noexcept;
  void begin_set() noexcept;
  void read_typed() noexcept;
  void end_act() noexcept;
  void end_switch() noexcept;
  bool make_row(Nanoseconds now) noexcept;
  bool make_status_row(Nanoseconds now) noexcept;
  bool make_stack_row() noexcept;
  bool make_last_status_row(std::size_t row) noexcept;
  bool make_event_row() noexcept;
  bool make_help_row() noexcept;
  bool make_value_row(Nanoseconds now) noexcept;
  bool make_switch_row() noexcept;
  void answer() noexcept;

  // Small members first: code for near members is small.
  Phase phase_ = Phase::kRead;
  bool is_sending_ = false;
  bool is_losing_ = false;     // by receive() only
  std::size_t sent_ = 0;       // bytes of line_ and its end
  std::size_t operand_ = 0;    // whose name is looked up
  std::size_t at_ = 0;         // next name, row or element
  std::uint32_t index_ = 0;    // of the variable or task that was found
  std::atomic<std::uint32_t> lost_{0};  // written by receive() only; relaxed, pairs with nothing
  std::uint32_t lost_told_ = 0;
  std::atomic<std::uint32_t> rows_made_{0};  // whole ones in out_ so far; written by step(), pairs with next_byte()
  std::uint32_t rows_sent_ = 0;              // by next_byte() only
  ShellParts parts_;
  CommandLine command_;
  StackScan scan_{Stack()};
  ShellAct act_;
  std::array<std::byte, kMostValueBytes> value_{};
  TypedValue typed_{{}, {}, {}, value_};
  LineReader reader_;
  TextLine line_;              // being made, or being sent
  TextLine why_;               // the line is refused; empty: it is not
  bare::ByteRing<128> in_;
  bare::ByteRing<256> out_;
};

}  // namespace chimera::firmware
