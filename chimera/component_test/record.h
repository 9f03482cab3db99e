// SPDX-License-Identifier: Apache-2.0
// The record of the child that runs a component, in memory that it shares with the judge. It survives every end of the
// child.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/task/abi.h"
#include "chimera/task/state_machine.h"

namespace chimera::component_test {

/// The present stage of the child. kEnd: its scenario is complete.
enum class Stage : std::uint32_t { kLoad, kStart, kRows, kFaults, kBadInputs, kSafeState, kLeftovers, kStop, kEnd };

/// A cycle.
struct RowRecord {
  std::uint64_t valid = 0;   ///< bits of the out-vars
  std::int64_t time_ns = 0;  ///< time of the method cycle
  std::uint8_t answer = 0;   ///< Answer of the cycle, after the checks of the safety ports
  std::uint8_t state = 0;    ///< State after the cycle
  bool is_run = false;
};

/// Calls of one method to the heap and to the system, over all its runs.
struct MethodRecord {
  std::uint64_t calls = 0;
  std::uint64_t allocations = 0;  ///< number of all allocations
  std::uint64_t most_allocations = 0;
  std::uint64_t system_calls = 0;
  std::uint64_t most_system_calls = 0;
  std::uint64_t first_system_call = 0;  ///< number of the system call
};

/// The way in which a task came back to ON after a disturbance.
enum class Return : std::uint8_t { kNone, kAtOnce, kByOn, kByClear, kBySpawn, kNot };

struct Trouble {
  bool is_tried = false;
  bool has_happened = false;  ///< the fault was returned, or the values were read
  State after = State::kNotCreated;
  Return how = Return::kNone;
  bool refused_clear = false;
  bool is_finite = true;     ///< the outputs of the later cycles are finite
  bool is_rejected = false;  ///< a cycle returned a fault
  char text[CHIMERA_FAULT_TEXT] = {};
};

/// The outputs of a safe state while the illegal-configuration flag was up, and after it came down.
struct SafeStateRecord {
  bool is_tried = false;    ///< it has such outputs, and was ON
  std::uint32_t cycles = 0; ///< under the flag until all were true; 0: never
  bool is_left = false;     ///< one was false after the flag came down
};

/// The number of kinds of spoil() (component_test/inputs.h).
inline constexpr std::size_t kBadInputs = 5;
inline constexpr std::size_t kRounds = 4;

/// The resources that remain after a kill.
struct Round {
  std::int64_t blocks = 0;
  std::uint32_t descriptors = 0;
  std::uint32_t threads = 0;
};

/// The fixed part; rows and outputs follow in their own memory.
struct Record {
  // Written by the child, read by the watcher. `watched` is sequentially consistent, so that a system call between the
  // two stores of a method counts for that method. `progress` is relaxed and pairs with nothing.
  std::atomic<std::uint32_t> watched{0};  ///< 1 + method while counted code of the component runs
  std::atomic<std::uint64_t> progress{0};
  Stage stage = Stage::kLoad;
  std::uint32_t method = CHIMERA_METHODS;  ///< the running method, or the last one
  std::uint32_t row = 0;
  bool is_traced = false;

  char refusal[CHIMERA_FAULT_TEXT + 120] = {};   ///< the reason why the component did not load or start
  std::int64_t measuring_ns[1000] = {};          ///< cost of an empty measurement
  std::uint32_t counts[CHIMERA_MAX_PORTS] = {};  ///< elements in use of each out-var
  std::uint32_t rejected = 0;                    ///< cycles that returned a fault
  std::uint32_t lost = 0;                        ///< times that clear failed and the task was spawned again
  std::uint32_t unsafe = 0;                      ///< publications that a safety port refused
  std::uint32_t first_rejected = 0;              ///< its row
  char first_text[CHIMERA_FAULT_TEXT] = {};
  char unsafe_text[CHIMERA_FAULT_TEXT] = {};
  MethodRecord methods[CHIMERA_METHODS];
  Trouble faults[CHIMERA_METHODS];
  Trouble bad_inputs[kBadInputs];
  SafeStateRecord safe_state;
  Round rounds[kRounds];
  char left_open[200] = {};  ///< a descriptor that the last round did not close
};

/// The record of one scenario, in memory shared with later children. Movable. Context: setup.
class SharedRecord {
 public:
  /// For `rows` cycles of a task whose outputs need `payload` bytes together.
  SharedRecord(std::size_t rows, std::size_t payload);

  Record& record() const noexcept { return *reinterpret_cast<Record*>(memory_.bytes().data()); }
  std::span<RowRecord> rows() const noexcept;
  /// The outputs as published with row `i`.
  std::span<std::byte> outputs(std::size_t i) const noexcept;

 private:
  std::size_t rows_, payload_;
  FamilyMemory memory_;
};

/// The place of an output in the payload of a row, in the order of the out-vars of the task.
struct OutputPlace {
  const PortSpec* spec = nullptr;
  std::size_t offset = 0;
  std::size_t bytes = 0;
};
/// The out-vars of the task, packed one after another. Context: setup.
std::vector<OutputPlace> output_places(const ApplicationSpec& spec, std::size_t& payload);

}  // namespace chimera::component_test
