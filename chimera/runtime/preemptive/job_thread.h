// SPDX-License-Identifier: Apache-2.0
// What a preemptive context keeps of one task and its thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "chimera/platform/descriptor_bell.h"
#include "chimera/platform/doorbell.h"
#include "chimera/platform/halt.h"
#include "chimera/platform/process_id.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/schedule/server_state.h"

namespace chimera {

/// Where the present job of a task is.
enum class JobPhase : std::uint8_t {
  kNone,       ///< its thread sleeps, or is on its way to
  kWaiting,    ///< its thread is lowered and was not dispatched yet
  kChanged,    ///< waiting, and the supervisor is changing it
  kCancelled,  ///< it was waiting and is no more: its thread goes to sleep again
  kBegun,      ///< the body runs
  kDone,       ///< it has ended; its thread raises itself, or has: nobody else changes its level any more
  kMethod,     ///< no job: the edge runs another method of the task
};

/// What a task behind a server has beside that. Written in the section.
struct Served {
  explicit Served(const ServerSpec& spec) noexcept : server(spec, {}) {}

  ServerState server;
  Nanoseconds due;           ///< of the server
  Nanoseconds charged;       ///< execution time of the thread up to which the server has paid
  Nanoseconds taken;         ///< when the present event was
  bool is_active = false;    ///< an event waits or is served
  bool has_event = false;    ///< one was taken; its job waits for capacity, or is under way
  bool is_halted = false;    ///< in the middle of its job, for want of capacity
  Halt halt;
  DescriptorBell bell;       ///< where its thread waits, in place of the other one, while it listens to a descriptor
};

/// Written in the section by whoever is in it, unless said otherwise.
struct JobThread {
  TaskId task;
  std::thread thread;
  std::atomic<std::uint32_t> bell_word{0};
  Doorbell bell{bell_word, Ringers::kThisProcess};  ///< rung when the thread has something to look at
  pid_t id = 0;                        ///< of the thread
  pid_t carrier = 0;                   ///< who runs at the label of the task: the thread, or that of the edges
  std::atomic<JobPhase> phase{JobPhase::kNone};

  Nanoseconds next = kNever;   ///< release to come; kNever: the task is not ON, or no event has come
  bool is_joined = false;      ///< is ON as far as the thread was told
  bool is_less_important = false;  ///< than others by what never changes: gives way before they do
  bool is_held = false;        ///< no job begins
  bool is_awaited = false;     ///< an edge came for the task and found a job under way
  bool illegal = false;        ///< the flag, for the present job

  Job job;                     ///< the present one; by its own thread read when it begins
  std::uint64_t cycle = 0;     ///< its number, as it was released
  Nanoseconds check = kNever;  ///< the supervisor looks at the job then
  bool is_demoted = false;
  bool is_given_up = false;    ///< it does not end by itself
  bool is_hanging = false;     ///< that is to be told
  std::atomic<std::int64_t> used_before{0};  ///< of the thread's execution time, by earlier jobs; by the thread itself
  Nanoseconds charged;         ///< what it had used when it was last looked at
  Nanoseconds seen_used, seen_at;  ///< the same, of every look
  Nanoseconds slept;           ///< for how long it has used nothing though it could
  std::atomic<std::int64_t> slice{0};  ///< since when it has the processor, as far as can be told; also by the thread
  Nanoseconds shown;           ///< when its profile was last handed out
  bool is_shown = true;        ///< as it is
  std::optional<Served> served;  ///< behind a server
};

}  // namespace chimera
