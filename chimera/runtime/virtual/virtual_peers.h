// SPDX-License-Identifier: Apache-2.0
// The rtpus of an application that runs in virtual time in one process: one context for each, and its view of the
// others. A context reads the present state of another one, without delay. There is no manager: this class keeps the
// operator variables and the operator's part of the flag.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/life/illegal_flag.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/state/peer_layout.h"
#include "chimera/runtime/state/peer_view.h"

namespace chimera {

/// A signal of a task on its way to a task of another context.
struct VirtualPost {
  Signal signal = Signal::kOn;
  TaskId target;
  bool is_echo = false;  ///< `reinit` because a constant changed elsewhere
};

/// Used by one thread. Context of everything not marked: cycle boundary; no allocation.
class VirtualPeers final : public PeerView {
 public:
  /// Operator variables have their initial values. Refuses what PeerLayout refuses. The spec outlives it. Context:
  /// setup.
  static Result<std::unique_ptr<VirtualPeers>> create(const ApplicationSpec& spec);
  /// Shows the context of the rtpu, which was built with this as its view of others, to the others. The context
  /// outlives all use of this. Context: setup.
  void join(RtpuId rtpu, TaskSet& tasks);

  State state(TaskId task) const noexcept override;
  PeerPresence presence(TaskId task) const noexcept override;
  GroupReader outputs(TaskId task) const noexcept override;
  GroupReader constants(TaskId task) const noexcept override;
  GroupReader operator_variable(std::size_t index) const noexcept override;
  /// False if the rtpu of the target is dead, or has kMostPosts to take.
  bool post(Signal signal, TaskId target, TaskId from, bool is_echo) noexcept override;
  bool has_manager() const noexcept override { return is_start_; }
  /// Between begin and end of the start, which was judged as a whole, no `on` is judged by itself.
  void show_start(bool is_under_way) noexcept { is_start_ = is_under_way; }

  /// Rung when the context of the rtpu has new input.
  const std::atomic<std::uint32_t>& bell(RtpuId rtpu) const noexcept { return peers_[rtpu.index].bell; }
  void ring(RtpuId rtpu) noexcept { peers_[rtpu.index].bell.fetch_add(1, std::memory_order_relaxed); }
  /// States of tasks of that rtpu, or its part of the flag, changed: all others are rung.
  void show_change(RtpuId by) noexcept;
  /// Notes that the rtpu reads the states of all others now. Returns the number of changes since the start.
  std::uint64_t look(RtpuId by) noexcept { return peers_[by.index].looked = changes_; }
  /// The next signal for the rtpu; false: there is none.
  bool take(RtpuId rtpu, VirtualPost& post) noexcept;

  /// Sets whether a task or a reaction of the rtpu raises the flag. True if that is new.
  bool show_raised(RtpuId rtpu, bool is_raised) noexcept;
  /// The operator raises or lowers the flag.
  void raise(bool up) noexcept;
  /// From now on `flag`, that of the rtpu, reads the parts of all living rtpus, and the operator's.
  void watch_flags(RtpuId rtpu, IllegalFlag& flag) noexcept;
  /// The flag as rtpus that live see it.
  bool is_flag_up() const noexcept;
  /// Publishes a value of operator variable `index`: as many bytes as the description gives.
  void set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept;

  /// The rtpu is dead: its tasks that were created are in ERROR, its publications stay readable.
  void die(RtpuId rtpu, Nanoseconds now) noexcept;
  /// When it died; kNever: it lives.
  Nanoseconds died(RtpuId rtpu) const noexcept { return peers_[rtpu.index].died; }
  /// Null: no task is on that rtpu.
  TaskSet* tasks(RtpuId rtpu) const noexcept { return peers_[rtpu.index].tasks; }
  const ApplicationSpec& spec() const noexcept { return spec_; }

  static constexpr std::size_t kMostPosts = 256;

 private:
  struct Peer {
    TaskSet* tasks = nullptr;
    bool is_dead = false;
    Nanoseconds died = kNever;
    std::uint64_t looked = 0;  // changes_, when it did last
    std::atomic<std::uint32_t> bell{0};    // relaxed, pairs with nothing: one thread rings and listens
    std::atomic<std::uint32_t> raised{0};  // relaxed, pairs with nothing: one thread writes and reads
    std::vector<VirtualPost> posts;        // room for kMostPosts
    std::size_t n_taken = 0;               // of posts
    std::vector<const std::atomic<std::uint32_t>*> flags;  // `raised` of the others
  };

  explicit VirtualPeers(const ApplicationSpec& spec) : spec_(spec), peers_(spec.rtpus.size()) {}
  Result<void> lay_out_operators();
  const Peer& peer_of(TaskId task) const noexcept { return peers_[spec_.tasks[task.index].rtpu.index]; }
  GroupWriter operator_writer(std::size_t index) noexcept;

  const ApplicationSpec& spec_;
  HeapMemory heap_;
  PeerLayout operators_;
  std::span<std::byte> operator_table_;
  std::vector<Peer> peers_;              // by rtpu
  std::atomic<std::uint32_t> raised_{0};  // by the operator; relaxed, as Peer::raised
  std::uint64_t changes_ = 0;
  bool is_start_ = false;
};

}  // namespace chimera
