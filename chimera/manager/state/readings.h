// SPDX-License-Identifier: Apache-2.0
// The present values of state variables, read from the segments of all processes. The value is from the producer that
// is ON; if there is none, from the one that wrote last.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/manager/state/own_segment.h"
#include "chimera/manager/state/peers.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/text/value_text.h"
#include "chimera/verify/configuration.h"

namespace chimera::manager {

/// A variable at one instant.
struct VariableReading {
  std::vector<std::byte> value;  ///< as many elements as its extents have now
  chimera_slot slot{};           ///< of the publication of the value; sequence 0: never published
  TaskId producer;               ///< invalid: the operator, or no producer
  bool is_valid = false;         ///< written at least once, or given an initial value
  ValueForm form;

  /// Age at `at`; 0 if it was published later.
  Nanoseconds age(Nanoseconds at) const noexcept {
    return {std::max<std::int64_t>(at.count - std::max<std::int64_t>(slot.published_ns, 0), 0)};
  }
};

/// Context: setup; may allocate. All arguments outlive it.
class Readings {
 public:
  /// State of a task as users see it.
  using StateOf = std::function<State(TaskId)>;

  Readings(const Peers& peers, const OwnSegment& own, const Configuration& configuration, const Library& library,
           StateOf state_of);

  const Variables& variables() const noexcept { return variables_; }
  const ConfiguredVariable& configured(VariableId variable) const noexcept {
    return *forms_[variable.index].configured;
  }
  std::size_t size() const noexcept { return variables_.all().size(); }
  /// The variable of that name.
  std::optional<VariableId> find(std::string_view name) const noexcept;
  bool is_operators(VariableId variable) const noexcept {
    return variables_.all()[variable.index].is_given();
  }
  /// The present or last producer; invalid: the operator, or no producer was ever created.
  TaskId producer(VariableId variable) const;
  VariableReading read(VariableId variable) const;
  /// Reads all but the value, which may be large.
  VariableReading read_header(VariableId variable) const;
  /// The form of the value of the variable, with its present extents.
  ValueForm form(VariableId variable) const;

 private:
  struct Form {
    const ConfiguredVariable* configured = nullptr;
    ValueForm form;
    const ExtentSpec* extents = nullptr;  // of the first producer, or the operator's
  };
  Form form_of(std::size_t variable, const Configuration& configuration, const Library& library) const;
  std::uint32_t extent(const ExtentSpec& extent) const;
  bool is_on(const PortOf& port) const { return peers_.status(port.task).state == State::kOn; }
  std::optional<std::int64_t> constant(ConstantId id) const;
  /// Null: no producer is ON, and none has written.
  const PortOf* source(const Variable& variable) const;
  VariableReading read(VariableId variable, bool with_value) const;
  bool read_output(const PortOf& port, chimera_slot& slot, std::vector<std::byte>* value) const;

  const Peers& peers_;
  const OwnSegment& own_;
  StateOf state_of_;
  Variables variables_;
  std::vector<Form> forms_;
  std::unordered_map<std::string_view, VariableId> by_name_;
};

}  // namespace chimera::manager
