// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/simulation.h"

#include "tests/subsystem/driver.h"
#include "tests/subsystem/face.h"
#include "tests/subsystem/judge.h"
#include "tests/subsystem/keeper.h"
#include "tests/subsystem/process.h"

namespace chimera::simulated {
namespace {

constexpr std::size_t kFaces = 4;
constexpr Nanoseconds kChaos = seconds(16);
constexpr std::size_t kMostEvents = 400'000;

/// Failures at random instants.
class Chaos {
 public:
  explicit Chaos(ManagerState& world) : world_(world) {}

  void plan() {
    Chance& chance = world_.chance;
    for (std::size_t n = 5 + chance.below(4); n > 0; --n) sometime([this] { kill_process(); });
    for (std::size_t n = chance.below(3); n > 0; --n)
      sometime([this] { world_.processes[world_.chance.below(Plan::kRtpus)]->stall(); });
    for (std::size_t n = 1 + chance.below(4); n > 0; --n) sometime([this] { kill_manager(); });
    for (std::size_t n = 60; n > 0; --n) sometime([this] { send_between_tasks(); });
    for (std::size_t n = 60; n > 0; --n) sometime([this] { wake_a_task(); });
    if (chance.percent(30)) world_.keeper->set_crasher(RtpuId(chance.below(Plan::kRtpus)), 5);
    world_.agenda.at(kChaos, [this] { end(); });
  }

 private:
  // A process that did not pass its point of death dies now.
  void end() {
    if (world_.signals < 200) return world_.agenda.after(seconds(1), [this] { end(); });
    for (auto& process : world_.processes)
      if (process->is_doomed() || world_.deaths < 5) process->die("death idle");
    if (world_.driver->is_doomed()) world_.driver->die("manager death idle");
    world_.is_calm = true;
  }

  void sometime(std::function<void()> what) {
    world_.agenda.at(world_.chance.between(seconds(1), kChaos), std::move(what));
  }

  void kill_process() {
    Chance& chance = world_.chance;
    Process& process = *world_.processes[chance.below(Plan::kRtpus)];
    if (!process.is_alive()) return again();
    const std::size_t kind = chance.below(12);
    static constexpr Point kPoints[] = {Point::kStarting,   Point::kBeforeStep,   Point::kAfterStep,
                                        Point::kInsideList, Point::kBeforeReport, Point::kAfterReport,
                                        Point::kInService};
    if (kind == 0) process.die("death idle");  // and again when it starts
    if (kind < 7) process.doom(kPoints[kind], false);
    else if (kind == 7) process.doom(kPoints[1 + chance.below(6)], true);
    else if (kind == 8) process.hang("hang idle");
    else process.die("death idle");
    if (kind == 9 || kind == 0) world_.driver->doom();
  }
  void again() {
    world_.agenda.after(milliseconds(50), [this] {
      if (!world_.is_calm) kill_process();
    });
  }
  void kill_manager() {
    if (world_.chance.percent(75)) world_.driver->doom();
    else world_.driver->die("manager death idle");
    if (world_.chance.percent(30)) world_.processes[world_.chance.below(Plan::kRtpus)]->die("death idle");
  }

  TaskId task_that_is_on() {
    const TaskId task(world_.chance.below(world_.n_tasks()));
    const Process& process = world_.process_of(task);
    return process.state(task) == State::kOn && !process.is_hung() ? task : TaskId{};
  }
  // `off`, `kill`, `clear`, `reinit` and `spawn` go straight to the rtpu of the target; `on` asks the manager.
  void send_between_tasks() {
    const TaskId from = task_that_is_on();
    if (!from.is_valid()) return;
    const TaskId target(world_.chance.below(world_.n_tasks()));
    const auto signal = static_cast<Signal>(world_.chance.below(CHIMERA_SIGNAL_WAKEUP));
    ++world_.signals;
    if (signal == Signal::kOn) {
      world_.tally.count("request for on");
      world_.process_of(from).request(from, target);
    } else {
      world_.tally.count("signal between tasks");
      world_.process_of(target).receive({0, 0, signal, {target}});
    }
  }
  void wake_a_task() {
    const TaskId task = task_that_is_on();
    if (task.is_valid()) world_.process_of(task).receive({0, 0, Signal::kWakeup, {task}});
  }

  ManagerState& world_;
};

void run_out(ManagerState& world) {
  for (std::size_t n = 0; !world.agenda.is_empty() && world.failure.empty(); ++n) {
    if (n == kMostEvents) return world.fail("no end");
    world.agenda.run_next();
    world.judge->look();
  }
}

/// In a calm world everything a person asks for must work: from whatever is left to the start set ON.
class Repair {
 public:
  explicit Repair(ManagerState& world) : world_(world) {}

  void run() {
    for (auto& process : world_.processes) {
      process->doom(Point::kNone, false);
      process->wake();
    }
    if (!world_.driver->is_alive()) world_.fail("no manager");
    step(Signal::kOff, State::kOn);
    step(Signal::kClear, State::kError);
    step(Signal::kSpawn, State::kNotCreated);
    if (!world_.failure.empty()) return;
    ask(Signal::kOn, {world_.plan.spec.start.begin(), world_.plan.spec.start.end()});
    for (std::size_t t = 0; t < world_.n_tasks() && world_.failure.empty(); ++t) {
      const bool starts = t < world_.plan.spec.start.size();
      const State wanted = starts ? State::kOn : State::kOff;
      if (world_.process_of(TaskId(t)).state(TaskId(t)) != wanted)
        world_.fail("the repair did not bring a task where it should");
    }
  }

 private:
  void step(Signal signal, State from) {
    std::vector<TaskId> tasks;
    for (std::size_t t = 0; t < world_.n_tasks(); ++t)
      if (world_.failure.empty() && world_.driver->subsystem().state(TaskId(t)) == from) tasks.push_back(TaskId(t));
    if (!tasks.empty()) ask(signal, std::move(tasks));
  }
  void ask(Signal signal, std::vector<TaskId> tasks) {
    Face& face = *world_.faces[0];
    face.ask(signal, std::move(tasks));
    run_out(world_);
    if (world_.failure.empty() && (face.is_waiting() || !face.last().is_accepted()))
      world_.fail(std::string("repair: ") + signal_name(signal) + ": " + face.last().refusal.text());
  }

  ManagerState& world_;
};

}  // namespace

ManagerState::ManagerState(std::uint64_t seed, Defect planted, bool prints)
    : chance(seed), trace(prints), plan(chance), variables(plan.spec), defect(planted) {
  for (std::size_t r = 0; r < Plan::kRtpus; ++r) processes.push_back(std::make_unique<Process>(*this, RtpuId(r)));
  keeper = std::make_unique<Keeper>(*this);
  driver = std::make_unique<ManagerLoop>(*this);
  judge = std::make_unique<Judge>(*this);
  for (std::size_t f = 0; f < kFaces; ++f) faces.push_back(std::make_unique<Face>(*this, f));
}

ManagerState::~ManagerState() = default;

void ManagerState::fail(std::string what) {
  if (!failure.empty()) return;
  trace.note(now(), "FAILS", {}, what);
  failure = std::move(what);
}

Outcome simulate(std::uint64_t seed, Defect defect, bool prints) {
  ManagerState world(seed, defect, prints);
  Chaos chaos(world);
  chaos.plan();
  world.keeper->begin();
  for (auto& face : world.faces) face->live();
  run_out(world);
  if (world.failure.empty()) world.judge->look_at_the_end();
  if (world.failure.empty()) Repair(world).run();
  if (world.failure.empty()) world.judge->look_at_the_end();
  if (world.failure.empty() && world.signals < 200) world.fail("less than 200 signals");
  if (world.failure.empty() && world.deaths < 5) world.fail("less than 5 deaths");
  return {world.failure, world.trace.hash(), world.signals, world.deaths, world.n_tasks(), world.tally};
}

}  // namespace chimera::simulated
