// SPDX-License-Identifier: Apache-2.0
// What the child that runs a component writes down, in memory that it shares with the judge: it stands as far as the
// child came, however that ended.
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

/// Where the child is. kEnd: it came to the end of its scenario.
enum class Stage : std::uint32_t { kLoad, kStart, kRows, kFaults, kBadInputs, kSafeState, kLeftovers, kStop, kEnd };

/// One cycle.
struct RowRecord {
  std::uint64_t valid = 0;   ///< bits of the out-vars
  std::int64_t time_ns = 0;  ///< that the method cycle took
  std::uint8_t answer = 0;   ///< Answer of the cycle, after the safety ports were looked at
  std::uint8_t state = 0;    ///< State after it
  bool is_run = false;
};

/// What one method asked of the heap and of the system, over all its calls.
struct MethodRecord {
  std::uint64_t calls = 0;
  std::uint64_t allocations = 0;  ///< all
  std::uint64_t most_allocations = 0;
  std::uint64_t system_calls = 0;
  std::uint64_t most_system_calls = 0;
  std::uint64_t first_system_call = 0;  ///< its number
};

/// How a task came back after something was done to it.
enum class Return : std::uint8_t { kNone, kAtOnce, kByOn, kByClear, kBySpawn, kNot };

struct Trouble {
  bool is_tried = false;
  bool has_happened = false;  ///< the fault was answered, the values were read
  State after = State::kNotCreated;
  Return how = Return::kNone;
  bool refused_clear = false;
  bool is_finite = true;     ///< the outputs of the cycles after it
  bool is_rejected = false;  ///< a cycle answered with a fault
  char text[CHIMERA_FAULT_TEXT] = {};
};

/// What its outputs that are a safe state said while the illegal-configuration flag was up, and when it was down again.
struct SafeStateRecord {
  bool is_tried = false;    ///< it has such outputs, and was ON
  std::uint32_t cycles = 0; ///< under the flag until all were true; 0: they never were
  bool is_left = false;     ///< one was false when the flag was down again
};

/// What spoil() (component_test/inputs.h) knows.
inline constexpr std::size_t kBadInputs = 5;
inline constexpr std::size_t kRounds = 4;

/// What is there after a kill.
struct Round {
  std::int64_t blocks = 0;
  std::uint32_t descriptors = 0;
  std::uint32_t threads = 0;
};

/// Fixed part; rows and outputs follow in their own memory.
struct Record {
  // Written by the child, read by the watcher: `watched` with sequential consistency, so that a system call between the
  // two stores of a method is counted for that method; `progress` relaxed, a figure that pairs with nothing.
  std::atomic<std::uint32_t> watched{0};  ///< 1 + method while the component's own code runs that is counted
  std::atomic<std::uint64_t> progress{0};
  Stage stage = Stage::kLoad;
  std::uint32_t method = CHIMERA_METHODS;  ///< that runs, or ran last
  std::uint32_t row = 0;
  bool is_traced = false;

  char refusal[CHIMERA_FAULT_TEXT + 120] = {};   ///< why the component could not be loaded or started
  std::int64_t measuring_ns[1000] = {};          ///< what it takes to measure nothing
  std::uint32_t counts[CHIMERA_MAX_PORTS] = {};  ///< elements in use of each out-var
  std::uint32_t rejected = 0;                    ///< cycles that answered with a fault
  std::uint32_t lost = 0;                        ///< times that clear did not help and it was spawned anew
  std::uint32_t unsafe = 0;                      ///< publications that a safety port refused
  std::uint32_t first_rejected = 0;              ///< its row
  char first_text[CHIMERA_FAULT_TEXT] = {};
  char unsafe_text[CHIMERA_FAULT_TEXT] = {};
  MethodRecord methods[CHIMERA_METHODS];
  Trouble faults[CHIMERA_METHODS];
  Trouble bad_inputs[kBadInputs];
  SafeStateRecord safe_state;
  Round rounds[kRounds];
  char left_open[200] = {};  ///< a descriptor that the last round left
};

/// The record of one scenario, in memory shared with children forked afterwards. Movable. Context: setup.
class SharedRecord {
 public:
  /// For `rows` cycles of a task whose outputs take `payload` bytes together.
  SharedRecord(std::size_t rows, std::size_t payload);

  Record& record() const noexcept { return *reinterpret_cast<Record*>(memory_.bytes().data()); }
  std::span<RowRecord> rows() const noexcept;
  /// The outputs as published with row `i`.
  std::span<std::byte> outputs(std::size_t i) const noexcept;

 private:
  std::size_t rows_, payload_;
  FamilyMemory memory_;
};

/// Where each output lies in the payload of a row, in the order of the task's out-vars.
struct OutputPlace {
  const PortSpec* spec = nullptr;
  std::size_t offset = 0;
  std::size_t bytes = 0;
};
/// The out-vars of the one task, packed one behind the other. Context: setup.
std::vector<OutputPlace> output_places(const ApplicationSpec& spec, std::size_t& payload);

}  // namespace chimera::component_test
