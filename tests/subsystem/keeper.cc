// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/keeper.h"

#include "tests/subsystem/driver.h"
#include "tests/subsystem/judge.h"
#include "tests/subsystem/process.h"

namespace chimera::simulated {

Keeper::Keeper(ManagerState& world) : world_(world), alive_(Plan::kRtpus), incarnations_(Plan::kRtpus) {
  memory.goals.resize(world.n_tasks());
  memory.handled.resize(Plan::kRtpus);
  memory.restarts.resize(Plan::kRtpus);
}

void Keeper::begin() {
  for (std::size_t r = 0; r < Plan::kRtpus; ++r) start_now(RtpuId(r));
  world_.driver->start();
}

void Keeper::start(RtpuId rtpu) {
  world_.agenda.after(world_.chance.between(microseconds(50), milliseconds(5)), [this, rtpu] { start_now(rtpu); });
}

void Keeper::start_now(RtpuId rtpu) {
  if (alive_[rtpu.index]) return;
  alive_[rtpu.index] = true;
  world_.processes[rtpu.index]->start(++incarnations_[rtpu.index]);
  world_.judge->changed();
  if (rtpu != crasher_ || crashes_ == 0) return;
  --crashes_;
  world_.agenda.after(world_.chance.between(milliseconds(1), milliseconds(600)), [this, rtpu] {
    world_.processes[rtpu.index]->die("death of a crasher");
  });
}

void Keeper::dies(RtpuId rtpu) {
  world_.agenda.after(world_.chance.between(microseconds(20), milliseconds(2)), [this, rtpu] {
    alive_[rtpu.index] = false;
    world_.judge->changed();
    world_.driver->ended(rtpu, incarnations_[rtpu.index]);
  });
}

void Keeper::manager_dies() {
  const Nanoseconds longest = world_.chance.percent(40) ? milliseconds(1) : milliseconds(300);
  world_.agenda.after(world_.chance.between(microseconds(50), longest), [this] { world_.driver->start(); });
}

}  // namespace chimera::simulated
