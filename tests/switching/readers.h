// SPDX-License-Identifier: Apache-2.0
// Judges what readers saw of the variable: of one producer, the one of the release, and no release left out.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/switching/toys.h"

namespace chimera::switching_trial {

class Readers {
 public:
  Readers() { last_.fill(kNever); }
  /// From now on exactly this life of a producer is to be seen.
  void begin(std::uint32_t life) {
    changes_ = {{Nanoseconds{}, life}};
    last_.fill(kNever);
    is_strict_ = true;
  }
  /// Until begin(), values read under the flag are not judged. A value read without the flag must come from a life that
  /// a committed switch began.
  void let_loose() { is_strict_ = false; }
  bool is_strict() const { return is_strict_; }
  /// Jobs released at `at` or later see that life.
  void change(Nanoseconds at, std::uint32_t life) { changes_.push_back({at, life}); }
  /// Releases of this reader up to `until` may be lost.
  void excuse(TaskId reader, Nanoseconds until) { excused_[reader.index] = until; }
  /// The reader was not ON.
  void forget(TaskId reader) { last_[reader.index] = kNever; }

  /// Error in a cycle of a reader; "": none. `outcome_of(plan)`: 1 committed, 0 open, -1 aborted.
  template <class OutcomeOf>
  std::string judge(const Look& look, Nanoseconds period, OutcomeOf outcome_of) {
    const std::string who = "reader " + std::to_string(look.reader.index) + " of release " +
                            std::to_string(look.release.count / 1000) + " us ";
    Nanoseconds& last = last_[look.reader.index];
    const bool is_next = last == kNever || look.release == last + period;
    last = look.release;
    if (!is_next && look.release > excused_[look.reader.index]) return who + "is not the next one";
    const Life life = stage.lives[look.mark.life];
    const bool is_for_nothing = life.plan != 0 && outcome_of(life.plan) <= 0;
    if (!look.illegal && is_for_nothing) return who + "sees life " + text(look.mark) + ", which is armed or was undone";
    if (!is_strict_) return "";
    if (look.illegal) return who + "sees the flag up";
    const std::uint32_t wanted = life_at(look.release);
    if (look.mark.life != wanted || look.mark.by == By::kOff)
      return who + "sees life " + text(look.mark) + ", not " + std::to_string(wanted);
    return "";
  }

 private:
  struct Change {
    Nanoseconds at;
    std::uint32_t life;
  };
  static std::string text(Mark mark) {
    return std::to_string(mark.life) + (mark.by == By::kOn ? " by on" : mark.by == By::kOff ? " by off" : "");
  }
  std::uint32_t life_at(Nanoseconds release) const {
    std::uint32_t life = 0;
    for (const Change& change : changes_)
      if (change.at <= release) life = change.life;
    return life;
  }

  std::vector<Change> changes_;
  std::array<Nanoseconds, 8> last_, excused_{};
  bool is_strict_ = false;
};

}  // namespace chimera::switching_trial
