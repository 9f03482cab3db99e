// SPDX-License-Identifier: Apache-2.0
// A verified application: immutable, made only by verify(). It holds all data about a description for later stages,
// with the places in the file. spec() passes it to the runtime.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/description/draft.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/units/unit.h"

namespace chimera {

/// A port instance of a task, after verification.
struct ConfiguredPort {
  std::uint32_t declared = 0;  ///< index in the component's descriptor
  std::uint32_t instance = 0;
  std::uint32_t kind = 0;  ///< CHIMERA_IN_VAR ...
  std::string name;        ///< as declared; an instance of a repeated port as "in[2]"
  std::string variable;    ///< linked to; empty for resources and for in-consts without another source
  std::string type;        ///< "float64", "Pose"
  std::string unit;        ///< solved; "1" for none
  std::string shape;       ///< "" scalar, "[6]", "[ndof<=10]"
  std::string frame;       ///< as declared: the coordinate frame; may be empty
  Place at;                ///< of the alias, otherwise of the task
};

struct ConfiguredTask {
  std::string name;
  std::string component;
  std::string doc;  ///< one sentence of the component
  Place at;
  std::size_t rtpu = 0;
  double rate_hz = 0;
  bool is_aperiodic = false;
  bool has_event_source = false;
  bool is_hardware = false;  ///< has a resource port
  std::string standby_for;   ///< empty: not a standby
  Nanoseconds stale_after{};  ///< of a standby; 0: never
  bool is_hot = false;        ///< of a standby
  std::vector<ConfiguredPort> ports;
};

/// A task's port, by index.
struct PortRef {
  std::size_t task = 0;
  std::size_t port = 0;
};

/// A unit in which the file writes a value.
struct WrittenUnit {
  std::string text;   ///< empty: the file writes none
  Conversion from{};  ///< from the unit of the variable
};

/// A state variable or constant and all its producers and consumers, over all tasks.
struct ConfiguredVariable {
  std::string name;
  bool is_constant = false;
  bool is_given = false;  ///< by `operator` (a state variable) or `constants` of the file
  std::string type, unit, shape;
  WrittenUnit written;  ///< of the first number of its given or initial value
  Place at;  ///< of the given value, otherwise of the first producer
  std::vector<PortRef> producers;
  std::vector<PortRef> consumers;
};

/// An entry of `configurations`: its tasks in data-flow order.
struct ConfiguredSet {
  std::string name;
  Place at;
  std::vector<TaskId> order;  ///< hardware inputs first; loops cut at initial values
};

struct Model;

/// Cheap to copy: all copies share one immutable object. Context: setup.
class Configuration {
 public:
  struct Parts;

  const std::string& file() const noexcept;
  const std::string& subsystem() const noexcept;
  std::span<const ConfiguredTask> tasks() const noexcept;
  std::span<const ConfiguredVariable> variables() const noexcept;
  /// The state variable with the runtime id `id`. Requires: an id of spec().
  const ConfiguredVariable& variable(VariableId id) const noexcept;
  std::span<const ConfiguredSet> sets() const noexcept;
  /// Index in sets() of the configuration that goes ON at the start.
  std::size_t start() const noexcept;
  std::span<const RtpuSpec> rtpus() const noexcept;
  /// The description behind this configuration.
  const Draft& draft() const noexcept;
  /// The application for the runtime. Its spans live as long as any copy of this Configuration.
  const ApplicationSpec& spec() const noexcept;

  /// Requires: a model without faults; only verify() calls it.
  explicit Configuration(const Model& model);

 private:
  std::shared_ptr<const Parts> parts_;
};

}  // namespace chimera
