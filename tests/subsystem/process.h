// SPDX-License-Identifier: Apache-2.0
// A simulated rtpu: its tasks walk through the real table of the state machine, one method at a time, with answers by
// chance. It may die or hang at any point between two of them.
#pragma once

#include <deque>
#include <variant>
#include <vector>

#include "chimera/runtime/hosted/rtpu_block.h"
#include "tests/subsystem/world.h"

namespace chimera::simulated {

/// Signals that belong to one transaction.
struct Letter {
  std::uint64_t command = 0;  ///< 0: none
  std::uint32_t manager = 0;  ///< the manager that sent it; 0: a task
  Signal signal = Signal::kOn;
  std::vector<TaskId> tasks;
};

/// Points at which the process may die.
enum class Point { kNone, kStarting, kBeforeStep, kAfterStep, kInsideList, kBeforeReport, kAfterReport, kInService };

class Process {
 public:
  using Note = std::variant<subsystem::Reported, subsystem::Requested>;

  Process(ManagerState& world, RtpuId id);

  void start(std::uint32_t incarnation);
  void receive(Letter letter);
  /// A task of this process sends `on`: only the manager may.
  void request(TaskId from, TaskId target);
  /// Announces the segment of a new manager.
  void meet(std::uint32_t manager);
  void look_soon();

  void die(const std::string& point);
  /// Dies or hangs when it passes the point the next time.
  void doom(Point point, bool hangs) noexcept { doom_ = point, doom_hangs_ = hangs; }
  void hang(const char* point);
  bool is_doomed() const noexcept { return doom_ != Point::kNone; }
  /// Stops for longer than an answer may take, and then continues.
  void stall();
  void wake() noexcept { stalled_until_ = {}; }

  bool is_alive() const noexcept { return is_alive_; }
  bool is_hung() const noexcept { return is_hung_ || world_.now() < stalled_until_; }
  bool is_busy() const noexcept { return is_busy_ || !service_.empty(); }
  /// True if `signal` of the present manager to the task waits or is being carried out.
  bool is_sent(Signal signal, TaskId task) const noexcept;
  std::uint32_t incarnation() const noexcept { return incarnation_; }
  /// Status in its segment, also after its death.
  TaskStatus word(TaskId task) const { return words_[task.index]; }
  bool is_half_on(TaskId task) const { return half_on_[task.index] && word(task).state == State::kOff; }
  State state(TaskId task) const { return is_alive_ ? word(task).state : State::kNotCreated; }
  bool has_flag() const noexcept { return flag_; }
  std::uint32_t seen_changes() const noexcept { return seen_changes_; }
  const std::vector<Note>& notes() const noexcept { return notes_; }
  const std::string& cause() const noexcept { return cause_; }

 private:
  struct Work {
    Letter letter;
    std::size_t index = 0;
    std::vector<State> before;
    std::vector<bool> in_service;
    std::vector<std::size_t> undo;
    bool has_failed = false;
    bool is_not_ready = false;  // failed because `on` answered not yet: those before it stay ON
    std::size_t failed = 0;
  };
  struct Errand {
    TaskId task;
    Step step = Step::kInit;
    Letter letter;
    State before{};
  };
  void at(Nanoseconds when, std::function<void()> what);
  void later(Nanoseconds from, Nanoseconds to, std::function<void()> what);
  bool passes(Point point, const char* name);
  void serve();
  void try_attach();
  void poke();
  bool is_blocked(const Letter& letter, std::size_t before) const;
  void begin();
  void next_task();
  void walk(TaskId task, Step step);
  void walked(TaskId task, State state);
  void finish();
  void end_work();
  void errand(TaskId task, Step step, const Letter& letter, State before);
  void run_errand();
  void errand_step(Step step);
  Answer draw(Step step);
  void publish(TaskId task, State state, bool in_service);
  void report(const Letter& letter, TaskId task, bool accepted, Refusal why, State before, State after);
  void look();

  ManagerState& world_;
  RtpuId id_;
  bool is_alive_ = false;
  bool is_hung_ = false;
  bool is_serving_ = false;
  std::uint32_t incarnation_ = 0;
  std::uint64_t life_ = 0;  // counts deaths and hangs: what was planned before does not happen
  std::uint32_t manager_ = 0;
  std::uint32_t next_manager_ = 0;
  std::deque<Letter> letters_;
  bool is_busy_ = false;
  Work work_;
  std::deque<Errand> service_;
  std::vector<TaskStatus> words_;
  std::vector<bool> half_on_;  // by task: its `on` answered not yet last
  std::vector<Note> notes_;
  bool flag_ = false;
  bool look_is_due_ = false;
  std::uint32_t seen_changes_ = 0;
  Point doom_ = Point::kNone;
  bool doom_hangs_ = false;
  Nanoseconds stalled_until_;
  std::string cause_;
};

}  // namespace chimera::simulated
