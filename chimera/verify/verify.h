// SPDX-License-Identifier: Apache-2.0
// Stage 2: a draft and the descriptors of the library become a Configuration, or a report of all faults.
#pragma once

#include <optional>

#include "chimera/description/draft.h"
#include "chimera/description/report.h"
#include "chimera/verify/configuration.h"

namespace chimera {

class Library;

/// `configuration` exists exactly if the report has no error, or only those of Overload::kShown. It may come with
/// warnings.
struct Verdict {
  std::optional<Configuration> configuration;
  Report report;
};

/// The result for budgets that exceed a CPU.
enum class Overload : std::uint8_t {
  kRefused,  ///< an error
  kTold,     ///< a warning, for commands that show what would fit
  kShown,    ///< an error; if there are no others, the configuration is made nevertheless
};

/// Judges a draft by every legality rule. Faults that follow from another fault are omitted. The configuration needs
/// neither draft nor library afterwards. Context: setup.
Verdict verify(const Draft& draft, const Library& library);

/// Judges a reading, including faults of the text; `check`, `run` and `schedule` call only this. Context: setup.
Verdict verify(const ReadDescription& reading, const Library& library, Overload overload = Overload::kRefused);

/// The shared objects of its components that cannot be loaded, as far as visible without running their code; empty:
/// none. `library` is the library of its verification. Context: setup; may block.
Report faulty_objects(const Configuration& configuration, const Library& library);

enum class Executor : std::uint8_t {
  kProcesses,
  kOneProcess,
  kVirtual,            ///< as its rtpu states: preemptive or not
  kPreemptiveVirtual,  ///< always preemptive
};

/// Parts of this configuration that the executor does not support yet, each by name and place; empty: it can run.
/// Context: setup.
Report unsupported(const Configuration& configuration, Executor executor);

}  // namespace chimera
