// SPDX-License-Identifier: Apache-2.0
// The line of an rtpu to its board: a thread that sends a frame every period and keeps the last one that arrived.
// docs/formats/link.md.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/platform/line/byte_line.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/link/frame.h"
#include "chimera/runtime/link/link_layout.h"
#include "chimera/task/state_machine.h"

namespace chimera {

/// State and publication of one task of the board in the last frame.
struct BoardTask {
  State state = State::kNotCreated;
  bool is_wanted = false;        ///< as the board had heard when it sent the frame
  std::uint32_t frames = 0;      ///< that arrived so far; 0: nothing is known
  std::uint16_t sequence = 0;    ///< of its publication
  Nanoseconds age;               ///< of its publication when the frame was sent
  board_link::FaultNews fault;         ///< its last fault that was told, if `has_fault`
  bool has_fault = false;
};

class BoardLine {
 public:
  enum class Life : std::uint32_t {
    kWaiting,    ///< no frame yet
    kForeign,    ///< frames of an image of another description arrive, and no other ones
    kUp,
    kSilent,     ///< it was up, and no frame came for `stale_after`
    kRestarted,  ///< it was up, and the board began anew
  };

  /// Serves the tasks of `rtpu`, which has a link. The spec outlives this. Context: setup.
  BoardLine(const ApplicationSpec& spec, RtpuId rtpu);
  BoardLine(const BoardLine&) = delete;
  BoardLine& operator=(const BoardLine&) = delete;
  ~BoardLine() { stop(); }

  /// Starts the thread. `ended` is set, and rung, shortly after the line went down. Context: setup.
  void start(WakeEvent& ended);
  /// From now on no task waits for the board to begin. Context: any.
  void end_waits() noexcept { waits_.store(false, std::memory_order_relaxed); }
  bool waits() const noexcept { return waits_.load(std::memory_order_relaxed); }
  /// Sends a last frame with no task wanted, then ends the thread. Context: setup; blocks.
  void stop();

  Life life() const noexcept { return life_.load(std::memory_order_acquire); }
  /// kSilent or kRestarted long enough that readers have seen it. Context: any; wait-free.
  bool has_ended() const noexcept { return has_ended_.load(std::memory_order_acquire); }
  /// "no frame came for 52 ms ('stale_after' is 50 ms)". Context: any.
  std::string trouble() const;

  const board_link::LinkLayout& layout() const noexcept { return layout_; }
  /// The number of the task among those of the board. Context: any; wait-free; O(tasks).
  std::size_t index_of(TaskId task) const noexcept;

  // Context of all: any thread; a lock that is held for a copy.
  void want(std::size_t i, bool on) noexcept;
  BoardTask task(std::size_t i) const;
  /// Copies the outputs of task `i` as of the last frame.
  void read_outputs(std::size_t i, std::byte* to) const;
  /// The value of import `i` for the next frame; it was published at `published`, CLOCK_MONOTONIC.
  void set_import(std::size_t i, const void* value, bool valid, Nanoseconds published);
  void set_flag(bool up) noexcept { flag_.store(up, std::memory_order_relaxed); }
  /// Waits until `is_it` holds for task `i`, at most `limit`. Context: setup, cycle boundary; blocks.
  template <class IsIt>
  bool await(std::size_t i, Nanoseconds limit, IsIt is_it) const {
    for (const Nanoseconds until = now() + limit; !is_it(task(i)); pause())
      if (now() >= until || is_stopping_.load()) return false;
    return true;
  }
  /// Longest time after which a working board has done what a frame asked it, and said so.
  Nanoseconds patience() const noexcept { return spec_.stale_after + spec_.period * 2; }

 private:
  static Nanoseconds now() noexcept;
  static void pause() noexcept;

  void run();
  bool open();
  void listen(Nanoseconds until);
  void accept(std::span<const std::byte> payload, Nanoseconds at);
  void look_for_silence(Nanoseconds at);
  void go_down(Life life, Nanoseconds at, std::string trouble);
  void send(Nanoseconds at);

  const LinkSpec spec_;
  HeapMemory memory_;
  board_link::LinkLayout layout_;
  ByteLine line_;
  board_link::FrameDecoder reader_;
  std::atomic<Life> life_{Life::kWaiting};
  std::atomic<bool> has_ended_{false}, is_stopping_{false}, flag_{false}, waits_{true};
  mutable std::mutex mutex_;  // of all below, down to trouble_
  std::vector<std::byte> from_board_, to_board_;
  std::vector<Nanoseconds> published_;  // by import
  std::vector<board_link::FaultNews> faults_;
  std::vector<bool> has_fault_;
  std::uint32_t frames_ = 0;
  std::uint32_t wanted_ = 0;
  std::string trouble_;
  // Only the thread uses these members:
  WakeEvent* ended_ = nullptr;
  Nanoseconds heard_at_, down_at_, opens_at_;
  std::uint64_t board_us_ = 0;
  std::uint16_t sequence_ = 0, last_sequence_ = 0;
  std::vector<std::byte> out_;
  std::size_t sent_ = 0;
  std::thread thread_;
};

}  // namespace chimera
