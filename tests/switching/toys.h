// SPDX-License-Identifier: Apache-2.0
// The tasks of the switching trials: producers of one variable in two or three rtpus, and readers of it that always
// cycle. What a producer writes says in which life, since which `on`, and by which method it was written.
#pragma once

#include <memory>
#include <vector>

#include "chimera/runtime/testing/test_application.h"

namespace chimera::switching_trial {

enum class By : std::uint8_t { kOn, kCycle, kOff };

/// Content of the variable. Life 0: it was never written.
struct Mark {
  std::uint32_t life = 0;
  By by = By::kCycle;
  double value() const noexcept { return life * 4.0 + static_cast<int>(by); }
  static Mark of(double value) noexcept {
    const auto whole = static_cast<std::uint32_t>(value);
    return {whole / 4, static_cast<By>(whole % 4)};
  }
};

/// One cycle of a reader.
struct Look {
  TaskId reader;
  Nanoseconds release;
  Mark mark;
  bool illegal;
};

/// A life of a task: from `on` to `off`.
struct Life {
  TaskId task;
  std::uint16_t plan = 0;  ///< the switch that `on` was called for; 0: a signal
  Nanoseconds at;          ///< when `on` was called
};

/// Script and records of the tasks. One run at a time.
struct Stage {
  std::vector<Life> lives{1};
  std::vector<Look> looks;     // since they were judged
  std::uint16_t open_plan = 0;  // of the page, when `on` is called
  bool next_on_fails = false;
  Nanoseconds on_takes, cycle_takes;
};
inline Stage stage;

inline constexpr TaskId kWatch0{0u}, kWatch1{1u}, kNear{2u}, kExtra{3u}, kShape{4u}, kFar{5u}, kWatch2{6u}, kThird{7u};

/// Common part of all producers.
template <unsigned kTask>
struct Living {
  std::uint32_t life = 0;
  bool begin(Cycle c) {
    c.spend(stage.on_takes);
    if (std::exchange(stage.next_on_fails, false)) return false;
    life = static_cast<std::uint32_t>(stage.lives.size());
    stage.lives.push_back({TaskId(kTask), stage.open_plan, c.now()});
    return true;
  }
  double by(By method) const { return Mark{life, method}.value(); }
};

template <unsigned kTask>
struct FreeSource {  // needs nothing
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle c) {
    const bool is_well = living.begin(c);
    if (is_well) *u = living.by(By::kOn);
    return is_well ? ok() : fault("as told");
  }
  void cycle(Cycle) { *u = living.by(By::kCycle); }
  void off(Cycle) { *u = living.by(By::kOff); }
  Living<kTask> living;
};

struct Far {  // needs what Shape produces
  In<double> w{"w", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle c) {
    const bool is_well = living.begin(c);
    if (is_well) *u = living.by(By::kOn);
    return is_well ? ok() : fault("as told");
  }
  void cycle(Cycle) { *u = living.by(By::kCycle); }
  void off(Cycle) { *u = living.by(By::kOff); }
  Living<kFar.index> living;
};

struct Shape {
  Out<double> w{"w", "1", initial = 0.0};
  void on(Cycle c) { c.spend(stage.on_takes); }
  void cycle(Cycle c) { *w = static_cast<double>(c.count()); }
};

struct Extra {  // needs u
  In<double> u{"u", "1"};
  Out<double> v{"v", "1", initial = 0.0};
  Outcome on(Cycle) {
    if (std::exchange(stage.next_on_fails, false)) return fault("as told");
    return ok();
  }
  void cycle(Cycle) { *v = *u; }
};

template <unsigned kTask>
struct Watch {
  In<double> u{"u", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle c) {
    *seen = *u;
    c.spend(stage.cycle_takes);
    stage.looks.push_back({TaskId(kTask), c.now(), Mark::of(*u), c.illegal()});
  }
};

/// The sets of tasks: their producer of u is in rtpu 0, 1, 0, 2. From kFirst to kSecond, and back, a task of rtpu 0
/// arrives and then one of rtpu 1.
inline constexpr std::uint32_t kFirst = 0, kSecond = 1, kBare = 2, kThirdRtpu = 3;

struct Application {
  /// Bit u of `preemptive`: rtpu u has a thread for each task.
  explicit Application(std::uint32_t n_rtpus, unsigned preemptive = 0) {
    const bool has_third = n_rtpus > 2;
    app.rtpus = {{"a", 0, Policy::kEdf}, {"b", 1, Policy::kMuf}};
    if (has_third) app.rtpus.push_back({"c", 2, Policy::kRm});
    for (std::size_t u = 0; u < app.rtpus.size(); ++u) app.rtpus[u].preemptive = (preemptive >> u & 1u) != 0;
    add<Watch<0>>("watch0", 0);
    add<Watch<1>>("watch1", 1, milliseconds(2));
    add<FreeSource<2>>("near", 0);
    add<Extra>("extra", 1);
    add<Shape>("shape", 0, milliseconds(2));
    add<Far>("far", 1);
    if (has_third) add<Watch<6>>("watch2", 2);
    if (has_third) add<FreeSource<7>>("third", 2, milliseconds(2));
    app.link(kWatch0.index, 1, "seen0");
    app.link(kWatch1.index, 1, "seen1");
    if (has_third) app.link(kWatch2.index, 1, "seen2");
    std::vector<TaskId> always{kWatch0, kWatch1};
    if (has_third) always.push_back(kWatch2);
    const std::vector<std::vector<TaskId>> others{{kNear, kExtra}, {kShape, kFar}, {kNear}, {kThird}};
    const char* const names[] = {"first", "second", "bare", "third"};
    for (std::size_t s = 0; s < (has_third ? 4u : 3u); ++s) {
      sets.push_back(others[s]);  // in the order of the data flow
      sets.back().insert(sets.back().end(), always.begin(), always.end());
      named.push_back({names[s], sets.back()});
    }
    for (std::size_t s = 0; s < sets.size(); ++s) named[s] = {names[s], sets[s]};
    app.make(sets[kFirst], false);
    app.spec.sets = named;
  }
  static TaskId producer(std::uint32_t set) {
    constexpr TaskId kOf[] = {kNear, kFar, kNear, kThird};
    return kOf[set];
  }

  testing::TestApplication app;
  std::vector<std::vector<TaskId>> sets;
  std::vector<NamedSet> named;

 private:
  template <class T>
  void add(const char* name, std::uint32_t rtpu, Nanoseconds period = milliseconds(1)) {
    TaskSpec& task = app.add(name, testing::component<T>(name), period);
    task.rtpu = RtpuId(rtpu);
    task.budget = microseconds(50);
  }
};

}  // namespace chimera::switching_trial
