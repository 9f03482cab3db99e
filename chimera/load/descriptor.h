// SPDX-License-Identifier: Apache-2.0
// The description of a component as plain owned data: the declaration of task/abi.h without its pointers. Checking,
// browsing and drawing read descriptors and never run component code. Files have the form of docs/formats/descriptor.md
// (catalogue/descriptor_json.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/shape.h"
#include "chimera/task/abi.h"

namespace chimera {

/// One field of a struct element. Sizes and offsets in bytes.
struct FieldDescriptor {
  std::string name{};
  std::string unit = "1";
  std::uint32_t type = CHIMERA_FLOAT64;  ///< CHIMERA_BOOL to CHIMERA_STRING
  std::uint32_t offset = 0;
  std::uint32_t count = 1;
  std::uint32_t size = 8;

  bool operator==(const FieldDescriptor&) const = default;
};

/// One declared port.
struct PortDescriptor {
  std::string name{};
  std::string doc{};
  std::string unit = "1";  ///< as written; may hold unit variables
  std::string shape{};       ///< as written
  std::string frame{};
  std::string type_name{};   ///< of the struct or of the type variable; "" otherwise
  std::uint32_t kind = CHIMERA_IN_VAR;
  std::uint32_t type = CHIMERA_FLOAT64;
  std::uint32_t element_size = 8;
  bool safety = false;
  bool repeated = false;
  std::uint32_t max_instances = 1;
  bool has_range = false;
  double min = 0, max = 0;            ///< in `unit`; count when has_range
  std::string at_least{};             ///< in-const: the in-const that no element is below; "" for none
  std::vector<std::string> one_of{};  ///< in-const of text: the legal words; empty: any
  bool names_configuration = false;   ///< in-const of text: a configuration of the description, or empty
  bool safe_state = false;            ///< out-var of bool: the device obeys the flag; resource: it never moves
  bool shared = false;                ///< resource: several tasks may open it together
  bool intermittent = false;          ///< in-var: a configuration may lack a producer
  std::vector<Extent> extents{};      ///< the parsed `shape`
  std::vector<FieldDescriptor> fields{};
  std::vector<std::byte> initial{};    ///< whole elements, padding zero: none, 1 (for all) or max_count()

  std::uint32_t max_count() const noexcept { return chimera::max_count(extents); }
  std::uint32_t initial_count() const noexcept;
  bool is_constant() const noexcept { return kind == CHIMERA_IN_CONST || kind == CHIMERA_OUT_CONST; }
  bool operator==(const PortDescriptor&) const = default;
};

/// A component. `valid(descriptor)` holds for each descriptor from describe() or from the file reader.
struct Descriptor {
  std::string name{};
  std::string doc{};
  std::string source{};
  std::uint32_t abi_version = CHIMERA_ABI_VERSION;
  double default_rate_hz = 0;  ///< 0: the description must give one
  std::uint32_t state_size = 0;
  std::uint32_t state_align = 8;
  std::array<bool, CHIMERA_METHODS> methods{};  ///< which of the nine are written
  bool background = false;                      ///< has a method that runs beside its cycles
  bool event_source = false;                    ///< its events come from a descriptor
  std::vector<PortDescriptor> ports{};

  /// True if it has a sync method, so that events release it.
  bool is_aperiodic() const noexcept { return methods[CHIMERA_SYNC]; }
  /// The port with that name, or nullptr.
  const PortDescriptor* port(std::string_view port_name) const noexcept;
  bool operator==(const Descriptor&) const = default;
};

/// "in-var", "out-var", "in-const", "out-const", "resource", "in-stream", "out-stream". Context: any; wait-free.
std::string_view kind_name(std::uint32_t kind) noexcept;
/// "bool", "int32", "int64", "float32", "float64", "string", "struct", "any".
std::string_view type_name(std::uint32_t type) noexcept;
/// Bytes of one element of a plain type; 0 for string and struct, whose size is declared.
std::uint32_t type_size(std::uint32_t type) noexcept;

/// [a-z][a-z0-9_]*, at most 64 letters: the legal names of components, ports, fields and extents.
bool is_identifier(std::string_view text) noexcept;

/// Checks a declaration and copies it. Refuses, with the names of the component and the port: illegal or repeated
/// names, sizes that do not fit the type, a shape that does not parse, an extent named after a port that is no
/// whole-number scalar constant, more than CHIMERA_MAX_PORTS instances, an unordered range, an order between ports that
/// are no in-consts of one type, unit and shape, words of a port that is no in-const of text, a safety port that is no
/// floating out-var, an initial value of a wrong count, not a number or outside the range. Context: setup; may block.
Result<Descriptor> describe(const chimera_component& component);

/// Applies the rules of describe() to a descriptor from another source. Fills in the extents from the shapes. Context:
/// setup; may block.
Result<void> complete(Descriptor& descriptor);

/// Names the first difference between a descriptor file and a loaded object that matters to binding: the port, and its
/// text on both sides. Documentation, source and state size may differ. Context: setup; may block.
Result<void> match(const Descriptor& file, const Descriptor& object);

/// A 64-bit hash over all that match() compares: equal descriptors match. Context: setup; may block.
std::uint64_t fingerprint(const Descriptor& descriptor);

}  // namespace chimera
