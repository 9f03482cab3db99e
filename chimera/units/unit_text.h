// SPDX-License-Identifier: Apache-2.0
// The grammar of unit texts (docs/formats/units.md). It knows no unit: a callback gives the meaning of a word.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/units/unit_expression.h"

namespace chimera {

inline constexpr std::size_t kMaxUnitText = 100;  ///< bytes
/// The space, and the no-break and thin ones that word processors put between a number and its unit.
inline constexpr std::string_view kSpaces[] = {" ", "\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf"};
inline constexpr int kMaxUnitExponent = 30;       ///< of a text as a whole, each base unit

/// The meaning of a word such as "kHz" or "U"; nullopt if it has none.
using WordMeaning = std::function<std::optional<UnitExpression>(std::string_view word)>;

/// Reads `text`. Refuses a text that breaks the grammar. Refuses a word without meaning, with the message from
/// `unknown`. Context: setup; bounded time.
Result<UnitExpression> read_unit_text(std::string_view text, const WordMeaning& meaning,
                                      const std::function<std::string(std::string_view word)>& unknown);

}  // namespace chimera
