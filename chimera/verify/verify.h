// SPDX-License-Identifier: Apache-2.0
// Stage 2 of the walk: a draft and the descriptors of the library become a Configuration, or a report of all faults.
#pragma once

#include <optional>

#include "chimera/description/draft.h"
#include "chimera/description/report.h"
#include "chimera/verify/configuration.h"

namespace chimera {

class Library;

/// `configuration` is there exactly when the report has no error. Warnings may come with it.
struct Verdict {
  std::optional<Configuration> configuration;
  Report report;
};

/// Budgets that take more of a CPU than there is: an error, or, for whoever wants to know what fits instead, a warning.
enum class Overload : std::uint8_t { kRefused, kTold };

/// Judges a draft by every legality rule. Faults that follow from another are left out.
/// The configuration needs neither draft nor library afterwards. Context: setup.
Verdict verify(const Draft& draft, const Library& library);

/// Judges what was read, faults of the text included: the one call of `check`, `run` and `schedule`. Context: setup.
Verdict verify(const ReadDescription& reading, const Library& library, Overload overload = Overload::kRefused);

/// The shared objects of its components that cannot be loaded, as far as can be seen without running code of them;
/// empty: none. `library` is the one it was verified with. Context: setup; may block.
Report faulty_objects(const Configuration& configuration, const Library& library);

enum class Executor : std::uint8_t {
  kProcesses,
  kOneProcess,
  kVirtual,            ///< as its rtpu says: preemptive or not
  kPreemptiveVirtual,  ///< preemptive, whatever it says
};

/// What the executor does not have yet and this configuration asks for, each by name and place;
/// empty: it can run. Context: setup.
Report unsupported(const Configuration& configuration, Executor executor);

}  // namespace chimera
