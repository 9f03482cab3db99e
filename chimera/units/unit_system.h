// SPDX-License-Identifier: Apache-2.0
// The units that texts may name, read from the UDUNITS-2 file of the framework (share/chimera/units.xml). Grammar and
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

/// Cheap to copy: all copies share one immutable set of units. Thread: any; one at a time runs inside.
class UnitSystem {
 public:
  /// Reads the file in the environment variable CHIMERA_UNITS; without it, the first of `files` that exists. Refuses,
  /// with the name, if none exists or if it is no unit file. Context: setup; may block.
  static Result<UnitSystem> load(std::span<const std::string> files);

  /// Reads the text of a unit file; `file` is its name for messages. Context: setup; may block.
  static Result<UnitSystem> of(std::string text, std::string file);

  /// The unit of "N.m/rad", "m/s2", "kg.m^2.s^-1", "%", "1". Refuses unknown words, unit variables, numbers other than
  /// 1, and a product after a "/". The message has the wrong word and the nearest known unit. Context: setup.
  Result<Unit> parse(std::string_view text) const;

  /// As parse(), but the unit variables U X Y Z are legal: "U", "U/s". Context: setup.
  Result<UnitExpression> parse_expression(std::string_view text) const;

  /// Every symbol and name of the file, without prefixes; the candidates of "nearest". Context: setup.
  std::span<const std::string> names() const noexcept;
  /// The file of the units.
  const std::string& file() const noexcept;
  /// The text of that file.
  const std::string& text() const noexcept;

 private:
  struct Content;
  explicit UnitSystem(std::shared_ptr<const Content> content) noexcept : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

}  // namespace chimera
