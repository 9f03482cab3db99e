// SPDX-License-Identifier: Apache-2.0
// Switches among real rtpus, stepped by hand, by seed: random sets at random instants, and in every second of them
// something that goes wrong at a random step: an rtpu or the manager dies, an rtpu is held up, the switch is cancelled,
// the flag is raised, a signal comes, `on` fails. What must hold is judged after every step.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/switching/chance.h"
#include "tests/switching/cut_links.h"
#include "tests/switching/readers.h"
#include "tests/switching/recorder.h"
#include "tests/switching/toys.h"

namespace chimera::switching_trial {

/// kOfModel: two rtpus, no restarts, and only deaths, hold-ups and cancels.
enum class Kind : std::uint8_t { kAll, kOfModel };

/// Result of a trial. `failure` "": everything held.
struct Tally {
  std::string failure;
  std::uint64_t switches = 0, done = 0, aborted = 0, rtpu_deaths = 0, manager_deaths = 0, hold_ups = 0, signals = 0,
                looks = 0;
  std::vector<std::string> events;  ///< of the model
};

/// One trial of `n_switches` of real rtpus.
Tally run_trial(std::uint64_t seed, std::uint32_t n_switches, Kind kind = Kind::kAll);
/// One trial of three rtpus in virtual time, some of them preemptive, that nothing disturbs but other requests.
Tally run_virtual_trial(std::uint64_t seed, std::uint32_t n_switches);
/// One trial of a random loop of tasks on one to three rtpus in virtual time.
Tally run_loop_trial(std::uint64_t seed, std::uint32_t n_switches);
/// One trial of persons who signal tasks during switches in virtual time. `signals`: those that a switch kept out.
Tally run_on_trial(std::uint64_t seed, std::uint32_t n_acts);

}  // namespace chimera::switching_trial
