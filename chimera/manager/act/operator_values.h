// SPDX-License-Identifier: Apache-2.0
// Values of operator variables: judged by the rules of a description, as if they stood in it, and written back in its
// words.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/catalogue/library.h"
#include "chimera/text/json.h"
#include "chimera/text/value_text.h"
#include "chimera/verify/configuration.h"

namespace chimera::manager {

/// The bytes of new values, by operator variable (index in ApplicationSpec::operators).
using OperatorBytes = std::map<std::size_t, std::vector<std::byte>>;

/// The bytes of `values` ({name: value}) by the rules of a description. A number counts in the unit of the variable; a
/// text carries its unit ("100 N.m/rad", "[1, 2]", "[1 2] rad"). Refuses all or none, in the words of these rules;
/// Error::where is the variable.
/// Requires: every name is an operator variable; `forms` has its present form. Context: setup; takes as long as a
/// verification: 4 ms for a chain of 256 tasks, the most that a file has.
Result<OperatorBytes> operator_bytes(const Configuration& configuration, const Library& library, const Json& values,
                                     const std::map<std::string, ValueForm>& forms);

/// A value as a description writes it: "true", "[100 N.m/rad, 90 N.m/rad]", "{x: 1 m, y: 2 m}". `columns`: elements of
/// a row, 0 if there is one dimension. Context: setup.
std::string description_text(const ValueForm& form, std::span<const std::byte> bytes, std::size_t columns);

}  // namespace chimera::manager
