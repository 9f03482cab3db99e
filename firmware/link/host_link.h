// SPDX-License-Identifier: Apache-2.0
// The link of an image to Linux: frames in, frames out, at the cycle boundaries. docs/formats/link.md.
//
//   interrupt   receive()   -> ring -> take() -> whole frame -> operator variables, wanted tasks, flag
//   interrupt   next_byte() <- frame <- take(), every period <- groups of the tasks
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/platform/bare/byte_ring.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/link/frame.h"
#include "chimera/runtime/link/link_layout.h"

namespace chimera::firmware {

/// To be given to the executor in its RunOptions. Nothing is ON until Linux asks for it. Without a frame for
/// `stale_after` the values from Linux are not valid and the illegal-configuration flag is up; the tasks stay ON.
class HostLink : public BoundaryListener {
 public:
  struct Times {
    Nanoseconds period;       ///< between two frames that it sends
    Nanoseconds stale_after;
    Nanoseconds tick;         ///< between two looks at what arrived
  };
  /// All tasks of the set are those of the link. The set outlives this, and is built. Context: setup.
  HostLink(TaskSet& set, const Times& times, SetupMemory& memory);
  HostLink(const HostLink&) = delete;
  HostLink& operator=(const HostLink&) = delete;

  // For the interrupts of the serial line. Context: any, one at a time; wait-free.
  /// A byte arrived; false if it does not fit. That damages a frame, which is dropped.
  bool receive(std::uint8_t byte) noexcept { return in_.add(byte); }
  /// The next byte to send; -1: there is none.
  int next_byte() noexcept;

  // Context: cycle boundary; wait-free; as long as the methods `on` and `off` of tasks take.
  void take(BoundarySignals& signals, Nanoseconds now) noexcept override;
  void publish() noexcept override {}
  void told(const SignalReport&, Nanoseconds) noexcept override {}
  void missed(TaskId, const MissCause::Verdict&, Nanoseconds) noexcept override {}
  void hangs(TaskWord, Nanoseconds, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId, Nanoseconds, Nanoseconds) noexcept override {}
  void show(const Task&) noexcept override {}

  /// Whole frames of this application, whole frames of others, and pieces that were no frame. Context: cycle boundary.
  std::uint32_t received() const noexcept { return received_; }
  std::uint32_t foreign() const noexcept { return foreign_; }
  std::uint32_t dropped() const noexcept { return reader_.dropped(); }
  bool is_stale() const noexcept { return is_stale_; }

 private:
  static constexpr std::uint32_t kStaleFlag = 2;  // beside board_link::kFlagIsUp

  bool accept(std::span<const std::byte> payload, Nanoseconds now) noexcept;
  void set_imports(const std::byte* payload, Nanoseconds now) noexcept;
  void go_stale() noexcept;
  void follow_wanted(BoundarySignals& signals, Nanoseconds now) noexcept;
  void turn_on_wanted(BoundarySignals& signals, Nanoseconds now) noexcept;
  void send(Nanoseconds now) noexcept;
  std::size_t fill(std::byte* payload, Nanoseconds now) noexcept;
  std::size_t add_fault(std::byte* payload) noexcept;
  bool is_wanted(std::size_t i) const noexcept { return (wanted_ >> i & 1) != 0; }

  TaskSet& set_;
  Times times_;
  board_link::LinkLayout layout_;
  std::atomic<std::uint32_t> no_bell_{0};      // nothing rings: it looks at each tick
  std::atomic<std::uint32_t> flag_word_{kStaleFlag};
  const std::atomic<std::uint32_t>* const flags_[1] = {&flag_word_};
  std::span<std::byte> payload_, out_;
  // Bytes of out_. take() writes both when all bytes are sent; then only next_byte() does. Release pairs with acquire.
  std::atomic<std::uint32_t> out_size_{0}, out_sent_{0};
  Nanoseconds heard_at_, send_at_;
  std::uint32_t wanted_ = 0;
  std::uint32_t received_ = 0, foreign_ = 0;
  std::uint16_t sequence_ = 0, last_sequence_ = 0;
  std::uint8_t next_fault_ = 0;                // task whose fault goes into the next frame
  bool is_stale_ = true;
  board_link::FrameDecoder reader_;
  bare::ByteRing<512> in_;
};

}  // namespace chimera::firmware
