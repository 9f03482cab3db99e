// SPDX-License-Identifier: Apache-2.0
// The data that a peer shows to the others beside its groups: states, profiles, the flag, posts, the tap. Only its
// owner writes it; all others read it through read-only mappings. docs/formats/processes.md.
//
// The block of a segment lies at block_offset(layout) and is block_bytes(n_tasks) long. A reader takes n_tasks and
// n_peers from its own image, never from the block.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/runtime/hosted/pages.h"
#include "chimera/runtime/outbox.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/runtime/plan/switch_wish.h"
#include "chimera/runtime/plan/takeover.h"
#include "chimera/runtime/record/tap_ring.h"
#include "chimera/runtime/safe_frame.h"
#include "chimera/runtime/task_status.h"
#include "chimera/table/segment.h"
#include "chimera/task/profile.h"

namespace chimera {

enum class PeerPhase : std::uint32_t { kStarting, kServing, kEnding, kEnded };

inline constexpr std::uint32_t kOperatorFlag = 4;  ///< bit 2 of BlockHead::flag: an operator raised it
inline constexpr std::uint32_t kDrillFlag = 8;     ///< bit 3: up for a drill; ends with the manager that began it

/// At the start of a block. Words of one writer, the owner; other processes read.
/// `phase`, `flag`, `seen_changes` and `attended` are stored with release and loaded with acquire: what the owner wrote
/// before is seen with them. All others are figures: relaxed where they are written in a cycle, and pair with nothing.
struct alignas(64) BlockHead {
  std::uint64_t magic = 0;                     ///< kBlockMagic
  std::uint32_t peer = 0;
  std::uint32_t incarnation = 0;
  std::uint32_t n_tasks = 0;
  std::uint32_t n_peers = 0;
  std::atomic<PeerPhase> phase{PeerPhase::kStarting};
  std::atomic<std::uint32_t> flag{0};          ///< bit 0: the ON set is not legal; 1: a task raised it; the bits above
  std::atomic<std::uint32_t> running{0};       ///< TaskWord of the task and method; 0: between jobs
  std::atomic<std::uint32_t> serving{0};       ///< as `running`, for the service thread: init and kill
  std::atomic<std::uint32_t> seen_changes{0};
  std::atomic<std::uint64_t> lost_posts{0};  ///< events that found no room in the manager's ring
  std::atomic<std::uint64_t> beats{0};       ///< cycle boundaries passed; no growth: the rtpu hangs in `running`
  std::atomic<std::uint32_t> hung{0};        ///< as `running`: the method because of which the rtpu ends itself
  std::atomic<std::uint32_t> attended{0};    ///< rounds of its main thread: one every 50 ms, or it hangs
  std::atomic<std::int64_t> hung_limit{0};   ///< nanoseconds for which that method was waited for
  std::atomic<std::int64_t> hung_used{0};    ///< nanoseconds that it used, if it used too much; else 0
  char grant[424] = {};                      ///< one line about real-time rights, zero-terminated
  std::atomic<std::uint32_t> at_edge{0};     ///< as `running`, for a method called at a cycle boundary; 0: none
  std::atomic<std::uint32_t> background{0};  ///< as `running`: the background that is under way longest; 0: none
  std::atomic<std::uint32_t> jobs{0};        ///< cycles of the task in `running` that ended, as the main thread saw
  std::atomic<std::int32_t> pid{0};          ///< of the owner; 0: it has no process of its own
  SwitchProgress switching;                  ///< how far this rtpu has come with a switch
  SwitchWishWords wish;                      ///< the configuration that a task of this rtpu asked for last
};
inline constexpr std::uint64_t kBlockMagic = 0x314b4c42'4d494843;  // "CHIMBLK1" in memory

/// State that outlives the manager. Used in the manager's block only. Its successor reads it after the process is known
/// to be dead: pairs with nothing.
struct ManagerMemory {
  std::atomic<std::uint64_t> events{0};                         ///< number of the last event
  std::atomic<std::uint32_t> handled[kMaxRtpus];                ///< incarnation whose death was dealt with
  std::atomic<std::int64_t> restarts[kMaxRtpus][4];             ///< instants of the last restarts
  std::atomic<std::uint32_t> started{0};                        ///< 1: the start set has been asked for
  std::atomic<std::int64_t> started_at{0};                      ///< instant at which it went ON; 0: not yet
  /// The request of each rtpu that was dealt with, as wish_dealt_with(). Living rtpus read it, too: relaxed, pairs with
  /// nothing.
  std::atomic<std::uint64_t> wishes[kMaxRtpus];
  std::atomic<std::uint64_t> takeovers[kMaxRtpus];  ///< incarnation, and number of the last one that has a receipt
};

/// The journal of switches, used in the manager's block only. manager/state/switch_journal.h defines its format.
inline constexpr std::size_t kJournalBytes = (128u << 10) + 1024;
/// The LineJournal of events, used in the manager's block only: manager/state/line_journal.h.
inline constexpr std::size_t kEventJournalBytes = (32u << 10) + 64;

/// Views into a block over mapped bytes. Plain value; every accessor is O(1) and wait-free.
class BlockView {
 public:
  BlockView() noexcept = default;
  /// Requires: bytes.size() >= block_bytes(n_tasks), 64-byte aligned. Context: setup.
  BlockView(const std::byte* bytes, std::uint32_t n_tasks) noexcept;

  const BlockHead& head() const noexcept;
  /// In the manager's block: the status that the manager saw last, for its successor.
  TaskStatus status(TaskId task) const noexcept;
  /// True if the status is no valid word: something other than the owner has overwritten it.
  bool is_status_lost(TaskId task) const noexcept;
  /// Copied word by word: two numbers may be a cycle apart.
  Profile profile(TaskId task) const noexcept;
  /// In the manager's block: the goal of the task (goal bits), and whether its group goes to the tap.
  std::uint32_t goal(TaskId task) const noexcept;
  bool is_tapped(TaskId task) const noexcept;
  const PostProgress& progress(std::uint32_t peer) const noexcept;
  const PostRing& outbox(std::uint32_t peer) const noexcept;
  const TapRing& tap() const noexcept;
  const ManagerMemory& memory() const noexcept;
  const SwitchPart& switch_part() const noexcept;
  const TakeoverRing& takeovers() const noexcept;
  std::span<const std::byte> journal() const noexcept;
  std::span<const std::byte> event_journal() const noexcept;
  /// In the block of an rtpu: the frame to write for one of its tasks after the rtpu died.
  const SafeFrame& safe_frame(TaskId task, std::uint32_t index) const noexcept;
  bool is_there() const noexcept { return bytes_ != nullptr; }

 private:
  const std::byte* bytes_ = nullptr;
  std::uint32_t n_tasks_ = 0;
};

/// The owner's side.
class BlockOwner {
 public:
  BlockOwner() noexcept = default;
  /// Writes the head over zeroed bytes. Requires as BlockView. Context: setup.
  BlockOwner(std::byte* bytes, std::uint32_t peer, std::uint32_t incarnation, std::uint32_t n_tasks,
             std::uint32_t n_peers) noexcept;

  BlockHead& head() const noexcept;
  void set_status(TaskId task, TaskStatus status) const noexcept;  ///< release; pairs with BlockView::status
  Profile& profile(TaskId task) const noexcept;
  void set_goal(TaskId task, std::uint32_t goal) const noexcept;
  void set_tapped(TaskId task, bool tapped) const noexcept;
  PostProgress& progress(std::uint32_t peer) const noexcept;
  PostRing& outbox(std::uint32_t peer) const noexcept;
  TapRing& tap() const noexcept;
  ManagerMemory& memory() const noexcept;
  SwitchPart& switch_part() const noexcept;
  TakeoverRing& takeovers() const noexcept;
  std::span<std::byte> journal() const noexcept;
  std::span<std::byte> event_journal() const noexcept;
  std::span<SafeFrame, kSafeFrames> safe_frames(TaskId task) const noexcept;
  BlockView view() const noexcept { return BlockView(bytes_, n_tasks_); }

 private:
  std::byte* bytes_ = nullptr;
  std::uint32_t n_tasks_ = 0;
};

/// Bytes from the start of the segment to the block.
std::uint64_t block_offset(const TableLayout& layout) noexcept;
std::uint64_t block_bytes(std::uint32_t n_tasks) noexcept;
/// Bytes of a whole segment: groups and block.
inline std::uint64_t peer_segment_bytes(const TableLayout& layout, std::uint32_t n_tasks) noexcept {
  return block_offset(layout) + block_bytes(n_tasks);
}

}  // namespace chimera
