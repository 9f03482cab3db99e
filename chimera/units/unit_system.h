// SPDX-License-Identifier: Apache-2.0
// The units that texts may name, read from our UDUNITS-2 file (share/chimera/units.xml). Grammar and
// decisions: docs/formats/units.md. The only user of UDUNITS-2.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/units/unit.h"
#include "chimera/units/unit_expression.h"

namespace chimera {

/// Cheap to copy: all copies share one immutable set of units. Thread: any, one at a time inside.
class UnitSystem {
 public:
  /// Reads the file that the environment variable CHIMERA_UNITS names, else the first of `files` that exists.
  /// Refuses when there is none or when it is no unit file, naming it. Context: setup; may block.
  static Result<UnitSystem> load(std::span<const std::string> files);

  /// Reads the text of a unit file; `file` is its name for messages. Context: setup; may block.
  static Result<UnitSystem> of(std::string text, std::string file);

  /// The unit of "N.m/rad", "m/s2", "kg.m^2.s^-1", "%", "1". Refuses, naming the word that is wrong and the nearest
  /// known unit, unknown words, unit variables, numbers other than 1, and a product after a "/". Context: setup.
  Result<Unit> parse(std::string_view text) const;

  /// As parse(), but the unit variables U X Y Z are legal: "U", "U/s". Context: setup.
  Result<UnitExpression> parse_expression(std::string_view text) const;

  /// Every symbol and name of the file, without prefixes; the candidates of "nearest". Context: setup.
  std::span<const std::string> names() const noexcept;
  /// The file they came from.
  const std::string& file() const noexcept;
  /// The text of that file.
  const std::string& text() const noexcept;

 private:
  struct Content;
  explicit UnitSystem(std::shared_ptr<const Content> content) noexcept : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

}  // namespace chimera
