// SPDX-License-Identifier: Apache-2.0
// Posts between peers: for each pair one ring in the sender's segment, one writer, one reader. The reader's progress
// stands in the reader's own segment, so both map each other read-only. docs/formats/processes.md.
//
//   writer: ring[posted mod N] = post; posted = posted + 1 (release)
//   reader: taken..posted (acquire) | copy | progress = taken (release)
//   writer: room while posted - progress < N (acquire)
// Invariant: the writer never stores to a place between progress and posted, so a post is read whole. The death of
// either process keeps the invariant.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/task/signal.h"
#include "chimera/task/state_machine.h"

namespace chimera {

enum class PostKind : std::uint8_t { kSignal, kReport, kRequest, kEvent };

/// Subject of an event.
enum class EventKind : std::uint8_t {
  kState,      ///< task went from `before` to `after`
  kFault,      ///< method `detail` of the task failed; its text stands in the task's fault group
  kRefused,    ///< signal from task `from` refused, `why`
  kSignalled,  ///< signal from task `from` carried out
  kFlag,       ///< this rtpu's flag word went to `detail`; `from` raised it, if a task did
  kStop,       ///< reaction `stop` of the task: the rtpu turned all its tasks OFF
  kMissed,     ///< the task missed its deadline; `from` used the processor most, for `detail` ns: more than its budget
               ///< if a task did. Invalid `from`: for that time no task here had the processor
  kHang,       ///< a job of the task does not end: it was released `detail` ns ago; 0: its thread is gone. The rtpu
               ///< ends
  kGaveWay,    ///< a job of the task goes on below all others: jobs of the rtpu used `detail` ns of the last window,
               ///< nearly all that the kernel grants real-time threads
  kBlocked,    ///< the task missed its deadline with a job that waits in a system call, having used `detail` ns
  kNote,       ///< the task left a note; its text stands in the task's fault group
  kTakeover,   ///< the task went ON in place of `from`, `detail` ns after this rtpu found that one lost
};
inline constexpr auto kLastHappening = EventKind::kTakeover;

/// 64 bytes; what is not used is 0 (ids: invalid).
struct Post {
  std::uint64_t command = 0;  ///< number of the command it belongs to; 0: none
  Nanoseconds at;
  TaskId task;                ///< target, or subject
  TaskId from;                ///< the sending task
  Signal signal = Signal::kOn;
  PostKind kind = PostKind::kSignal;
  EventKind happening = EventKind::kState;
  bool more = false;          ///< one transaction with the next signal in the same ring
  std::uint8_t why = 0;       ///< Refusal
  State before = State::kNotCreated;
  State after = State::kNotCreated;
  std::uint64_t detail = 0;  ///< report: 1 accepted, 0 not; event: as its EventKind says
  std::uint64_t used = 0;  ///< kHang: execution time in ns, if the job used too much
  std::uint64_t reserved = 0;
};
static_assert(sizeof(Post) == 64);

inline constexpr std::size_t kPosts = 256;  ///< in one ring

/// Lies in the sender's segment.
struct PostRing {
  std::atomic<std::uint64_t> posted{0};  ///< store-release of Outbox::try_post() pairs with the acquire of Inbox::take
  std::uint64_t reserved[7] = {};
  Post posts[kPosts];
};

/// In the reader's segment: the incarnation of the sender in the upper 24 bits, posts taken in the lower 40.
struct PostProgress {
  std::atomic<std::uint64_t> word{0};  ///< store-release by the Inbox pairs with the acquire of Outbox::room()
};

/// The writing side: own ring, progress of the one reader.
class Outbox {
 public:
  Outbox() noexcept = default;
  Outbox(PostRing& ring, const PostProgress* progress, std::uint32_t my_incarnation) noexcept
      : ring_(&ring), progress_(progress), incarnation_(my_incarnation) {}

  /// False if the reader is a whole ring behind (or there is no reader: progress null and the ring full).
  /// Context: cycle; wait-free.
  [[nodiscard]] bool try_post(const Post& post) noexcept;
  /// Posts that would still be taken. Context: cycle; wait-free.
  std::uint64_t room() const noexcept;
  /// True if the reader takes the posts of this incarnation (and none from before). Context: cycle; wait-free.
  bool is_followed() const noexcept;
  /// Sets another incarnation of the reader; null: none. Context: cycle boundary.
  void set_reader(const PostProgress* progress) noexcept { progress_ = progress; }

 private:
  PostRing* ring_ = nullptr;
  const PostProgress* progress_ = nullptr;
  std::uint32_t incarnation_ = 0;
};

/// The reading side: the sender's ring, own progress.
class Inbox {
 public:
  Inbox() noexcept = default;
  /// Begins behind everything posted so far. Context: cycle boundary.
  Inbox(const PostRing& ring, PostProgress& progress, std::uint32_t sender_incarnation) noexcept;
  /// Goes on where `progress` stands, copied from a predecessor's. Begins behind everything if that belonged to another
  /// incarnation of the sender. Context: cycle boundary.
  static Inbox resume(const PostRing& ring, PostProgress& progress, std::uint32_t sender_incarnation) noexcept;

  /// The next post; false if there is none. This class uses nothing read from the ring as index or length. It passes
  /// over posts that no sender would write (a word that is no value of its enumeration).
  /// Context: cycle; wait-free.
  bool take(Post& post) noexcept;
  bool is_attached() const noexcept { return ring_ != nullptr; }

 private:
  const PostRing* ring_ = nullptr;
  PostProgress* progress_ = nullptr;
  std::uint32_t incarnation_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace chimera
