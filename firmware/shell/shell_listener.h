// SPDX-License-Identifier: Apache-2.0
// The shell at the cycle boundaries: carries out the act that a line asked for, and notes events.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "chimera/base/fixed.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "firmware/shell/recent_events.h"
#include "firmware/shell/text_line.h"

namespace chimera::firmware {

/// The act of one line.
struct ShellAct {
  static constexpr std::size_t kMostTasks = 8;
  enum class Kind : std::uint8_t { kSignal, kSet, kSwitch };

  Kind kind = Kind::kSignal;
  Signal signal = Signal::kOn;                ///< kSignal
  FixedVector<TaskId, kMostTasks> tasks;      ///< kSignal: one or more, each once
  std::uint32_t index = 0;                    ///< number of the operator variable (kSet) or configuration (kSwitch)
  std::span<const std::byte> value;           ///< kSet: in memory that stays until is_done()
};

/// To be given to the executor in its RunOptions. One thread; context of everything not marked: cycle boundary,
/// or between jobs; wait-free.
class ShellListener final : public BoundaryListener {
 public:
  /// The set outlives this, and is built. Takes 12 bytes for each task. Context: setup.
  ShellListener(TaskSet& set, SetupMemory& memory);
  ShellListener(const ShellListener&) = delete;
  ShellListener& operator=(const ShellListener&) = delete;
  /// The receipts of the executor that runs with this; they outlive this. Context: setup.
  void follow(const SwitchReceipts& receipts) noexcept { receipts_ = &receipts; }

  /// Asks for a cycle boundary that carries out the act, which outlives is_done(). Requires: is_done().
  void ask(const ShellAct& act) noexcept;
  /// The last act was carried out, or refused: refusal() says. A switch is done when it has begun, or was refused.
  bool is_done() const noexcept { return act_ == nullptr; }
  /// Why the last act was refused; empty: it was not. Requires: is_done().
  const TextLine& refusal() const noexcept { return refusal_; }

  /// The switch that the last act ordered, in memory of the executor; null: it is gone, because newer receipts took its
  /// place. Requires: the last act was a switch that was not refused.
  const SwitchReceipt* ordered() const noexcept { return ordered_->number == ordered_number_ ? ordered_ : nullptr; }
  /// The switch that the last act ordered is under way no more.
  bool is_switch_over() const noexcept;

  /// Looks at four tasks and at the last switch, in turn: notes new faults, missed deadlines, states, and the end of
  /// the switch. Call it before each wait.
  void look(Nanoseconds now) noexcept;
  RecentEvents& events() noexcept { return events_; }

  void take(BoundarySignals& signals, Nanoseconds now) noexcept override;
  void publish() noexcept override {}
  void told(const SignalReport& report, Nanoseconds now) noexcept override;
  void missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept override;
  void hangs(TaskWord, Nanoseconds, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId, Nanoseconds, Nanoseconds) noexcept override {}
  void show(const Task& task) noexcept override;

 private:
  struct Seen {
    std::uint32_t faults = 0, missed = 0;
    State state = State::kNotCreated;
  };

  void carry_out_signal(BoundarySignals& signals, Nanoseconds now) noexcept;
  void order_switch(BoundarySignals& signals, Nanoseconds now) noexcept;
  void note_news(const Task& task, Nanoseconds now) noexcept;
  void note_switch(Nanoseconds now) noexcept;

  TaskSet& set_;
  std::atomic<std::uint32_t> rings_{0};
  std::span<Seen> seen_;  // by task
  const SwitchReceipts* receipts_ = nullptr;
  const ShellAct* act_ = nullptr;  // to be carried out
  TextLine refusal_;
  const SwitchReceipt* ordered_ = nullptr;
  std::uint32_t ordered_number_ = 0;
  RecentEvents events_;
  Nanoseconds now_;               // of the last cycle boundary or look()
  std::uint32_t next_ = 0;        // task that look() looks at next
  std::uint32_t noted_switch_ = 0;  // number of the last switch whose end was noted
};

}  // namespace chimera::firmware
