// SPDX-License-Identifier: Apache-2.0
// Handles tasks of one rate together: a *class* is all tasks with one (period, offset), which are released together.
//
// Releases lie on a grid: origin + offset + k * period. A task that goes ON later starts with the first grid release at
// or after that instant. So off and on keep the phases between tasks.
//
// A release starts a *run*: the members of the class in urgency order. This order is static within a class, because all
// members were released at one instant.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/mechanisms.h"
#include "chimera/base/part_if.h"
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

/// A member of a class.
struct ClassMember {
  Nanoseconds deadline;   ///< relative
  [[no_unique_address]] ValueIf<mechanisms::kPreemptive, Nanoseconds> budget;  ///< for llf and muf-laxity
  Nanoseconds first;      ///< no release before this instant, because the task was not ON
  std::uint32_t task = 0;
  std::uint32_t criticality = 0;
  std::uint32_t user_priority = 0;
};

/// All tasks of one (period, offset).
struct TaskClass {
  Nanoseconds period, offset;
  Nanoseconds next;            ///< the next release
  Nanoseconds release;         ///< of the present run
  std::uint32_t begin = 0;     ///< first member; active members come first, in urgency order
  std::uint32_t active = 0;
  std::uint32_t size = 0;
  std::uint32_t cursor = 0;    ///< members of the present run already popped; == active: no run
};

/// Pure logic over given memory. Tasks are named by their index in the specification, classes by their own index.
/// Context of all functions but the constructor: cycle boundary, unless stated otherwise.
class TaskClasses {
 public:
  /// Memory for n tasks: every span has n elements, but `classes` one for each class.
  struct Storage {
    std::span<ClassMember> members;
    std::span<TaskClass> classes;
    std::span<std::uint32_t> class_of;
  };

  /// The number of classes of these tasks. Context: setup; O(tasks^2).
  static std::size_t count(std::span<const TaskSpec> tasks) noexcept;
  /// All tasks start inactive (OFF). `tasks` outlives this. Requires: period > 0. Context: setup.
  TaskClasses(Policy policy, std::span<const TaskSpec> tasks, const Storage& storage) noexcept;
  /// Sets the origin of the grid; 0 by default. Requires: no task has joined yet. Context: setup.
  void set_origin(Nanoseconds origin) noexcept { origin_ = origin; }

  Policy policy() const noexcept { return policy_; }
  TaskClass& operator[](std::uint32_t index) const noexcept { return storage_.classes[index]; }
  std::uint32_t class_of(std::uint32_t task) const noexcept { return storage_.class_of[task]; }
  /// The member at place `at` of its class.
  ClassMember& member(const TaskClass& c, std::uint32_t at) const noexcept { return storage_.members[c.begin + at]; }
  /// The member for `task`. O(class).
  const ClassMember& member_of(std::uint32_t task) const noexcept;
  /// The place of the task in its class. O(class).
  std::uint32_t place(std::uint32_t task) const noexcept;
  bool is_active(std::uint32_t task) const noexcept;
  /// The first release of an active task. O(class).
  Nanoseconds first_release(std::uint32_t task) const noexcept { return member_of(task).first; }

  /// Activates the task from the first grid release at or after `now`. Its place follows its urgency, behind the cursor
  /// of a present run. Requires: inactive. O(class).
  void activate(std::uint32_t task, Nanoseconds now) noexcept;
  /// Deactivates the task. Requires: active. O(class).
  void deactivate(std::uint32_t task) noexcept;

  // Context of the other functions: cycle; wait-free; O(1).
  static Job job(const TaskClass& c, const ClassMember& m) noexcept {
    return {TaskId(m.task), c.release, c.release + m.deadline};
  }
  static Urgency urgency(const TaskClass& c, const ClassMember& m) noexcept {
    return {m.criticality, m.user_priority, c.period, c.release + m.deadline, m.budget};
  }
  /// The urgency of the job at the cursor.
  Urgency urgency(std::uint32_t index) const noexcept;
  std::uint32_t task_at_cursor(std::uint32_t index) const noexcept;
  /// Compares by the policy; ties: user priority, then tie_of().
  bool goes_before(const Urgency& a, std::uint32_t a_task, const Urgency& b, std::uint32_t b_task) const noexcept;
  /// Compares the jobs at the cursors of two classes.
  bool run_goes_before(std::uint32_t a, std::uint32_t b) const noexcept;

 private:
  Nanoseconds grid_at_or_after(const TaskClass& c, Nanoseconds now) const noexcept;

  Policy policy_;
  std::span<const TaskSpec> tasks_;
  Storage storage_;
  Nanoseconds origin_;
};

}  // namespace chimera
