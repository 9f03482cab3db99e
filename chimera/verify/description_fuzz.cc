// SPDX-License-Identifier: Apache-2.0
// Reads any bytes as a description. The result is a refusal with places inside the text, or a configuration with a
// sound spec.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "chimera/base/testing/property.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/library.h"
#include "chimera/verify/outline.h"
#include "chimera/verify/verify.h"

namespace {

using namespace chimera;

/// The components of tests/verify: one of each kind of port.
const Library& library() {
  static const Library kLibrary = [] {
    const std::string units[] = {source_path("share/chimera/units.xml")};
    auto system = UnitSystem::load(units);
    require(system.has_value(), "CHIMERA_SOURCE is the source tree");
    const std::string folders[] = {source_path("tests/verify/components")};
    return Library::make(folders, *std::move(system));
  }();
  require(!kLibrary.entries().empty(), "there are components");
  return kLibrary;
}

void check_faults(const Report& report, std::size_t lines) {
  for (const Fault& fault : report.faults()) {
    require(!fault.message.empty(), "a fault says what it is");
    require(fault.port.empty() || !fault.task.empty(), "a port is that of a task");
    require(fault.at.line <= lines, "a fault stands in the text");
    require((fault.at.line == 0) == (fault.at.column == 0), "a place has a line and a column");
  }
  require(report.is_legal() || !report.faults().empty(), "what is refused has a fault");
  require(!report.json().empty(), "a report can be written");
}

void check_spec(const Configuration& made) {
  const ApplicationSpec& spec = made.spec();
  require(spec.init_order.size() == spec.tasks.size(), "every task is initialised");
  require(!spec.start.empty(), "something starts");
  for (const TaskSpec& task : spec.tasks) {
    require(task.period.count > 0 && task.deadline.count > 0 && task.deadline <= task.period, "times are in order");
    for (const PortSpec& port : task.ports) {
      require(port.type != CHIMERA_ANY, "types are solved");
      const bool is_text = port.element_bytes == 0;
      require(is_text || port.value.empty() || port.value.size() == port.max_bytes(), "values fill their ports");
    }
  }
}

#ifdef CHIMERA_PLANTED_DEFECT
/// A planted defect, to prove that the fuzzer finds one: a read beyond the end for a task name of more than 16 letters.
void planted(const Draft& draft) {
  for (const DraftTask& task : draft.tasks) {
    volatile char marks[17] = {};
    marks[std::min<std::size_t>(task.name.text.size(), 17)] = 1;
  }
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  const ReadDescription reading = read_description(text, "fuzz");
#ifdef CHIMERA_PLANTED_DEFECT
  if (reading.draft) planted(*reading.draft);
#endif
  const Outlined outlined = verify_with_outline(reading, library());
  const Verdict& verdict = outlined.verdict;
  require(!outlined.outline || !outline_json(*outlined.outline).empty(), "an outline can be written");
  require(verdict.configuration.has_value() == verdict.report.is_legal(), "legal is what becomes a configuration");
  check_faults(verdict.report, static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1);
  if (!verdict.configuration) return 0;
  check_spec(*verdict.configuration);
  check_faults(unsupported(*verdict.configuration, Executor::kOneProcess), size + 1);
  return 0;
}
