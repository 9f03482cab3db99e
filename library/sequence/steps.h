// SPDX-License-Identifier: Apache-2.0
// Decides when a sequence goes from one step to another: a pure machine without ports, stepped by the component and by
// tests. docs/formats/sequence.md has its rules.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string_view>

#include "chimera/base/time.h"

namespace chimera::library {

/// One step, as the component reads it at init.
struct SequenceStep {
  std::string_view name, configuration;
  Nanoseconds within;           ///< for the switch, and for the condition
  Nanoseconds wait;             ///< of `for`; 0: none
  bool has_condition = false;
  std::int32_t otherwise = -1;  ///< after `within`; below 0: stop
  bool confirm = false, reentry = false;
};

/// The output `sequence_state`.
enum class SequenceState : std::int32_t {
  kPaused,
  kSwitches,
  kRuns,
  kWaitsForGo,
  kInterrupted,
  kFailed,
  kDone,
  kBegins
};

/// The input of a cycle.
struct SequenceInput {
  Nanoseconds now;
  std::string_view in_force;  ///< the name of the configuration; "": none
  bool illegal = false;       ///< the illegal-configuration flag is up
  std::int32_t go = -1;       ///< newly set: 0 pauses, N goes to step N; below 0: nothing new
  bool holds = false;         ///< the condition of the present step, over a value published since it began
};

/// The sequence. Context of all functions: cycle; no allocation.
class SequenceSteps {
 public:
  static constexpr std::size_t kMost = 16;
  static constexpr Nanoseconds kAskAgain = seconds(1);

  /// `steps` outlive this; 1 to kMost, `otherwise` below their number.
  void prepare(std::span<const SequenceStep> steps, bool repeats) noexcept {
    steps_ = steps;
    repeats_ = repeats;
    state_ = SequenceState::kBegins;
    step_ = 0;
    has_step_ = has_lost_ = false;
    wanted_ = -1;
  }
  /// The task went ON. `after_death`: its process has died before, and no step is known.
  void on(Nanoseconds now, bool after_death) noexcept {
    began_ = asked_since_ = now;
    asked_at_ = kNever;
    if (after_death && state_ == SequenceState::kBegins) {
      state_ = SequenceState::kInterrupted;
      has_lost_ = true;
    }
  }
  /// Goes on from the outputs of an earlier life of the task. Call it before on().
  void restore(std::int32_t step, SequenceState state) noexcept {
    if (step < 1 || static_cast<std::size_t>(step) > steps_.size()) return;
    step_ = static_cast<std::size_t>(step - 1);
    has_step_ = true;
    const bool ran = state == SequenceState::kSwitches || state == SequenceState::kRuns;
    state_ = ran ? SequenceState::kInterrupted : state;
    has_lost_ = ran;
  }

  /// One cycle. After it, request() and note() are to be carried out.
  void cycle(const SequenceInput& in) noexcept {
    request_ = -1;
    note_[0] = '\0';
    if (in.go >= 0) obey(in);
    if (state_ == SequenceState::kBegins) begin(in);
    watch(in);
    advance(in);
    if (is_stable(in)) last_in_force_ = in.in_force;
  }

  /// The step whose configuration is to be requested; below 0: none.
  std::int32_t request() const noexcept { return request_; }
  /// For the user; "": nothing.
  const char* note() const noexcept { return note_.data(); }
  SequenceState state() const noexcept { return state_; }
  /// From 1; 0: none yet.
  std::int32_t step() const noexcept { return has_step_ ? static_cast<std::int32_t>(step_) + 1 : 0; }
  /// The step whose condition counts. Requires: state kRuns.
  std::size_t running() const noexcept { return step_; }
  /// The instant at which the configuration of the step was found in force. Requires: state kRuns.
  Nanoseconds began() const noexcept { return began_; }
  /// Since the step began, or since its switch is requested.
  Nanoseconds waited(Nanoseconds now) const noexcept {
    if (state_ == SequenceState::kRuns) return now - began_;
    return state_ == SequenceState::kSwitches ? now - asked_since_ : Nanoseconds{};
  }

 private:
  const SequenceStep& present() const noexcept { return steps_[step_]; }
  static bool is_stable(const SequenceInput& in) noexcept { return !in.in_force.empty() && !in.illegal; }
  bool is_in_force(std::size_t step, const SequenceInput& in) const noexcept {
    return !in.in_force.empty() && steps_[step].configuration == in.in_force;
  }

  template <class... Parts>
  void say(const char* format, Parts... parts) noexcept {
    std::snprintf(note_.data(), note_.size(), format, parts...);
  }
  static int length(std::string_view text) noexcept { return static_cast<int>(text.size()); }

  void obey(const SequenceInput& in) noexcept {
    if (in.go == 0) {
      pause();
    } else if (static_cast<std::size_t>(in.go) > steps_.size()) {
      say("there is no step %d: the last one is %zu", static_cast<int>(in.go), steps_.size());
    } else if (state_ == SequenceState::kBegins) {
      wanted_ = in.go;
    } else {
      enter(static_cast<std::size_t>(in.go - 1), in, true);
    }
  }
  void pause() noexcept {
    state_ = SequenceState::kPaused;
    wanted_ = -1;
  }

  // The first step waits until the start configuration is complete.
  void begin(const SequenceInput& in) noexcept {
    if (wanted_ > 0 && is_stable(in)) enter(static_cast<std::size_t>(wanted_ - 1), in, false);
  }

  void enter(std::size_t step, const SequenceInput& in, bool is_confirmed) noexcept {
    step_ = step;
    has_step_ = true;
    has_lost_ = is_disturbed_ = false;
    was_stable_ = is_stable(in);
    if (was_stable_) last_in_force_ = in.in_force;  // the step goes on from there, also if a person switched there
    asked_since_ = in.now;
    asked_at_ = kNever;
    state_ = SequenceState::kSwitches;
    if (present().confirm && !is_confirmed) {
      state_ = SequenceState::kWaitsForGo;
      say("step %zu '%.*s' waits for Go", step_ + 1, length(present().name), present().name.data());
    }
  }

  // A configuration that was requested before may still come into force.
  bool is_expected(const SequenceInput& in) const noexcept {
    for (std::size_t i = 0; i < steps_.size(); ++i)
      if ((asked_ >> i & 1u) != 0 && steps_[i].configuration == in.in_force) return true;
    return in.in_force == last_in_force_ || is_in_force(step_, in);
  }

  void watch(const SequenceInput& in) noexcept {
    switch (state_) {
      case SequenceState::kRuns:
        if (!is_stable(in)) return interrupt(in);
        if (!is_in_force(step_, in)) leave_to_person(in);
        return;
      case SequenceState::kWaitsForGo:
        if (is_stable(in) && !is_expected(in)) leave_to_person(in);
        return;
      case SequenceState::kSwitches:
        // A slow switch of its own raises the flag, too. A person may begin a step under the flag.
        is_disturbed_ = is_disturbed_ || (was_stable_ && !is_stable(in));
        has_lost_ = has_lost_ || (was_stable_ && in.in_force.empty());
        if (!is_stable(in) || is_in_force(step_, in)) return;
        was_stable_ = true;
        if (!is_expected(in)) return leave_to_person(in);
        if (is_disturbed_) interrupt(in);
        break;
      case SequenceState::kInterrupted:
        break;
      default:
        return;
    }
    if (state_ != SequenceState::kInterrupted) return;
    has_lost_ = has_lost_ || in.in_force.empty();
    if (is_stable(in)) resume(in);
  }

  void interrupt(const SequenceInput& in) noexcept {
    state_ = SequenceState::kInterrupted;
    has_lost_ = has_lost_ || in.in_force.empty();
    say("step %zu '%.*s' is interrupted", step_ + 1, length(present().name), present().name.data());
  }

  void leave_to_person(const SequenceInput& in) noexcept {
    pause();
    say_paused(in, "switched otherwise");
  }

  // After an error, an emergency stop or a death: the present step, or the only other one, if it allows that.
  void resume(const SequenceInput& in) noexcept {
    std::size_t n = 0, found = 0;
    for (std::size_t i = 0; i < steps_.size(); ++i)
      if (steps_[i].reentry && is_in_force(i, in)) found = i, ++n;
    const bool is_present = has_step_ && present().reentry && is_in_force(step_, in);
    if (is_present) found = step_, n = 1;
    // A person may have switched slowly, which raises the flag.
    const bool was_switched = !has_lost_ && in.in_force != last_in_force_;
    if (n != 1 || was_switched) {
      pause();
      return say_paused(in, was_switched ? "switched otherwise" : "interrupted");
    }
    enter(found, in, false);
    if (state_ == SequenceState::kSwitches)
      say("goes on with step %zu '%.*s'", found + 1, length(steps_[found].name), steps_[found].name.data());
  }

  void say_paused(const SequenceInput& in, const char* why) noexcept {
    say("%s in '%.*s': paused;", why, length(in.in_force), in.in_force.data());
    bool has_any = false;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (!steps_[i].reentry) continue;
      append(has_any ? "," : " may go on with step", i + 1);
      has_any = true;
    }
    if (!has_any) append(" no step allows reentry", 0);
  }
  void append(const char* text, std::size_t number) noexcept {
    std::size_t at = std::string_view(note_.data()).size();
    if (number == 0) std::snprintf(note_.data() + at, note_.size() - at, "%s", text);
    else std::snprintf(note_.data() + at, note_.size() - at, "%s %zu", text, number);
  }

  void advance(const SequenceInput& in) noexcept {
    if (state_ == SequenceState::kRuns) {
      const SequenceStep& step = present();
      if (step.has_condition ? in.holds : step.wait.count > 0 && in.now - began_ >= step.wait) next(in);
      else if (step.has_condition && in.now - began_ >= step.within) fail(in, "its condition does not hold");
    }
    if (state_ != SequenceState::kSwitches) return;
    if (is_stable(in) && is_in_force(step_, in)) {
      asked_ = 0;
      has_lost_ = false;
      began_ = in.now;
      const bool stays = !present().has_condition && present().wait.count == 0;
      state_ = stays ? SequenceState::kDone : SequenceState::kRuns;
    } else if (!is_disturbed_ && in.now - asked_since_ >= present().within) {
      fail(in, "its configuration does not come into force");
    }
    if (state_ == SequenceState::kSwitches) ask(in);
  }

  void ask(const SequenceInput& in) noexcept {
    if (is_disturbed_ || is_in_force(step_, in)) return;
    if (asked_at_ != kNever && in.now - asked_at_ < kAskAgain) return;
    asked_at_ = in.now;
    asked_ |= std::uint32_t{1} << step_;
    request_ = static_cast<std::int32_t>(step_);
  }

  void next(const SequenceInput& in) noexcept {
    if (step_ + 1 < steps_.size()) enter(step_ + 1, in, false);
    else if (repeats_) enter(0, in, false);
    else state_ = SequenceState::kDone;
  }

  void fail(const SequenceInput& in, const char* why) noexcept {
    const std::size_t failed = step_;
    const std::string_view name = present().name;
    if (present().otherwise < 0 || !is_stable(in)) {
      state_ = SequenceState::kFailed;
      return say("step %zu '%.*s' failed: %s; stopped", failed + 1, length(name), name.data(), why);
    }
    enter(static_cast<std::size_t>(present().otherwise), in, false);
    say("step %zu '%.*s' failed: %s; goes to step %zu '%.*s'%s", failed + 1, length(name), name.data(), why, step_ + 1,
        length(present().name), present().name.data(),
        state_ == SequenceState::kWaitsForGo ? ", which waits for Go" : "");
  }

  std::span<const SequenceStep> steps_;
  bool repeats_ = false;
  SequenceState state_ = SequenceState::kBegins;
  std::size_t step_ = 0;
  bool has_step_ = false;
  bool has_lost_ = false;      // kInterrupted: no configuration was in force since
  // kSwitches: the flag was down and a configuration in force; and then no longer
  bool was_stable_ = false, is_disturbed_ = false;
  std::int32_t wanted_ = -1;   // kBegins: the step to begin with
  std::uint32_t asked_ = 0;    // steps whose configurations were requested and did not come into force
  Nanoseconds began_, asked_since_, asked_at_ = kNever;
  std::string_view last_in_force_;
  std::int32_t request_ = -1;
  std::array<char, 160> note_{};
};

}  // namespace chimera::library
