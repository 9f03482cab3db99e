// SPDX-License-Identifier: Apache-2.0
// Every key of a description, in the order of docs/formats/description.md. The reader accepts no other;
// tests/verify/coverage.py compares them with description.schema.json.
#pragma once

#include <array>
#include <string_view>

namespace chimera {

inline constexpr std::array<std::string_view, 9> kFileKeys = {
    "version", "subsystem", "constants", "rtpus", "tasks", "operator", "configurations", "start", "sequence"};

inline constexpr std::array<std::string_view, 5> kRtpuKeys = {"cpu", "policy", "executor", "target", "link"};

/// Keys of `link` of an rtpu.
inline constexpr std::array<std::string_view, 5> kLinkKeys = {"serial", "udp", "baud", "rate", "stale_after"};

inline constexpr std::array<std::string_view, 25> kTaskKeys = {
    "component",     "rtpu",   "rate",        "deadline",    "offset",   "budget",   "min",        "criticality",
    "user_priority", "alias",  "constants",   "resources",   "initial",  "on_miss",  "on_overrun", "max_consecutive",
    "tolerate",      "server", "stale_after", "standby_for", "on_fault", "max_step", "stack",      "isolation",
    "safe_after"};

inline constexpr std::array<std::string_view, 2> kTolerateKeys = {"misses", "of"};

inline constexpr std::array<std::string_view, 3> kServerKeys = {"kind", "capacity", "period"};

/// Keys of a `standby_for` with a map.
inline constexpr std::array<std::string_view, 3> kStandbyKeys = {"task", "stale_after", "hot"};

/// Keys of a configuration with a map.
inline constexpr std::array<std::string_view, 2> kSetKeys = {"tasks", "safe_when"};

/// Keys of a `sequence` with a map.
inline constexpr std::array<std::string_view, 5> kSequenceKeys = {"rate", "rtpu", "budget", "repeat", "steps"};

/// Keys of a step of a sequence.
inline constexpr std::array<std::string_view, 8> kStepKeys = {"name", "switch", "until",   "for",
                                                              "within", "else",  "confirm", "reentry"};

}  // namespace chimera
