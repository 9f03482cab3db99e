// SPDX-License-Identifier: Apache-2.0
// Tasks of one rate as one: a *class* is all tasks with one (period, offset), which are released together.
//
// Releases lie on a grid: origin + offset + k * period, also for a task that goes ON later: its first release is
// the first one of the grid at or after that instant, so phases between tasks are kept over any off and on.
//
// A release starts a *run*: the members of the class in urgency order, which is static within a class, for all
// were released at the same instant.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/schedule/policy.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// One released cycle of one task.
struct Job {
  TaskId task;
  Nanoseconds release;
  Nanoseconds deadline;  ///< absolute
};

/// One member of a class.
struct ClassMember {
  Nanoseconds deadline;   ///< relative
  Nanoseconds budget;
  Nanoseconds first;      ///< no release before this instant: the task was not ON yet
  std::uint32_t task = 0;
  std::uint32_t criticality = 0;
  std::uint32_t user_priority = 0;
};

/// All tasks of one (period, offset).
struct TaskClass {
  Nanoseconds period, offset;
  Nanoseconds next;            ///< the coming release
  Nanoseconds release;         ///< of the present run
  std::uint32_t begin = 0;     ///< first member; active ones come first, in urgency order
  std::uint32_t active = 0;
  std::uint32_t size = 0;
  std::uint32_t cursor = 0;    ///< members of the present run already taken; == active: no run
};

/// Pure logic over given memory. Tasks are named by their index in the specification, classes by their own. Context of
/// all but the constructor: cycle boundary, where nothing else is said.
class TaskClasses {
 public:
  /// Memory for n tasks: every span has n elements.
  struct Storage {
    std::span<ClassMember> members;
    std::span<TaskClass> classes;
    std::span<std::uint32_t> class_of;
  };

  /// All tasks start outside (OFF). Requires: period > 0. Context: setup.
  TaskClasses(Policy policy, std::span<const TaskSpec> tasks, const Storage& storage) noexcept;
  /// The instant from which the grid counts, 0 until told. Requires: nobody has joined yet. Context: setup.
  void set_origin(Nanoseconds origin) noexcept { origin_ = origin; }

  Policy policy() const noexcept { return policy_; }
  TaskClass& operator[](std::uint32_t index) const noexcept { return storage_.classes[index]; }
  std::uint32_t class_of(std::uint32_t task) const noexcept { return storage_.class_of[task]; }
  /// The member at that place of its class.
  ClassMember& member(const TaskClass& c, std::uint32_t at) const noexcept { return storage_.members[c.begin + at]; }
  /// The member that is the task. O(class).
  const ClassMember& member_of(std::uint32_t task) const noexcept;
  /// The place of the task in its class. O(class).
  std::uint32_t place(std::uint32_t task) const noexcept;
  bool is_active(std::uint32_t task) const noexcept;
  /// The first release that the task, which is active, takes part in. O(class).
  Nanoseconds first_release(std::uint32_t task) const noexcept { return member_of(task).first; }

  /// The task takes part from the first release of the grid at or after `now`: in its place by urgency, behind the
  /// cursor of a run under way. Requires: it does not. O(class).
  void activate(std::uint32_t task, Nanoseconds now) noexcept;
  /// It takes part no more. Requires: it does. O(class).
  void deactivate(std::uint32_t task) noexcept;

  // Context of the rest: cycle; wait-free; O(1).
  static Job job(const TaskClass& c, const ClassMember& m) noexcept {
    return {TaskId(m.task), c.release, c.release + m.deadline};
  }
  static Urgency urgency(const TaskClass& c, const ClassMember& m) noexcept {
    return {m.criticality, m.user_priority, c.period, c.release + m.deadline, m.budget};
  }
  /// Of the job at the cursor.
  Urgency urgency(std::uint32_t index) const noexcept;
  std::uint32_t task_at_cursor(std::uint32_t index) const noexcept;
  /// By the policy; ties: user priority, then order of the tasks.
  bool goes_before(const Urgency& a, std::uint32_t a_task, const Urgency& b, std::uint32_t b_task) const noexcept;
  /// The same of the jobs at the cursors of two classes.
  bool run_goes_before(std::uint32_t a, std::uint32_t b) const noexcept;

 private:
  Nanoseconds grid_at_or_after(const TaskClass& c, Nanoseconds now) const noexcept;

  Policy policy_;
  Storage storage_;
  Nanoseconds origin_;
};

}  // namespace chimera
