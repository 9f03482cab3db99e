// SPDX-License-Identifier: Apache-2.0
// Parts of a legal description that an image for a target cannot have, and parts of the target that the description
// does not have. Each fault names what there is, the limit, and what to change.
#pragma once

#include "chimera/analysis/recorded_profile.h"
#include "chimera/bake/memory.h"
#include "chimera/bake/target.h"
#include "chimera/catalogue/library.h"
#include "chimera/description/report.h"
#include "chimera/verify/configuration.h"

namespace chimera::bake {

/// Context of all: setup.
/// Periods, offsets and deadlines that are no whole ticks.
void refuse_times(const Configuration& configuration, const Target& target, Report& report);
/// Features that the executive of an image lacks: several rtpus, preemption, laxity, servers, standbys, processes; and
/// components that need Linux.
void refuse_features(const Configuration& configuration, const Library& library, Report& report);
/// Resource ports without a text in the target, and event sources without an interrupt.
void refuse_unserved(const Configuration& configuration, const Target& target, Report& report);
/// Tasks, ports, pins and interrupts that the target names and that do not exist. `report` is of the target's file.
void refuse_unknown(const Configuration& configuration, const Target& target, Report& report);
/// A target without a serial line, another baud, a rate of broken ticks. `configuration`: the part of the board.
void refuse_link(const Configuration& configuration, const LinkSpec& link, const Target& target, Report& description,
                 Report& of_target);
/// Tables, records or stacks that exceed flash or RAM. `report` is of the target's file.
void refuse_memory(const MemoryNeed& need, const Target& target, Report& report);
/// Deadlines that are not guaranteed in some configuration by the times of the profile, which was recorded on the
/// target, with non-preemptive jobs and the longest slice of the shell; and tasks that the profile lacks.
void refuse_late(const Configuration& configuration, const RecordedProfile& profile, const Target& target,
                 Report& report);

}  // namespace chimera::bake
