// SPDX-License-Identifier: Apache-2.0
// Figures as the commands print them: short, with their unit, in columns of known width.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace chimera::cli {

/// "850 ns", "12.3 us", "1.20 ms", "45.1 s", "12.5 min", "3.4 h": three significant digits, at most 8 columns.
/// nullopt is "-". Context: setup.
std::string duration_text(std::optional<std::int64_t> ns);
/// "1 kHz", "62.5 Hz", "998 Hz", "0.1 Hz"; 0 is "-".
std::string rate_text(double hz);
/// "1234", "12.3k", "45.1M": at most 5 columns.
std::string count_text(std::int64_t count);

}  // namespace chimera::cli
