// SPDX-License-Identifier: Apache-2.0
// Instants and durations: signed 64-bit nanoseconds, 292 years either way.
#pragma once

#include <compare>
#include <cstdint>

// A job compares instants twenty times. A compiler that saves bytes would call a function for it; where it does not,
// its own choice is the quicker one.
#ifdef __OPTIMIZE_SIZE__
#define CHIMERA_COMPARED_IN_PLACE [[gnu::always_inline]]
#else
#define CHIMERA_COMPARED_IN_PLACE
#endif

namespace chimera {

/// A duration, or an instant on a clock that the context names (monotonic, or virtual from 0).
/// Context: any; wait-free.
struct Nanoseconds {
  std::int64_t count = 0;

  CHIMERA_COMPARED_IN_PLACE constexpr bool operator==(const Nanoseconds&) const noexcept = default;
  CHIMERA_COMPARED_IN_PLACE constexpr auto operator<=>(const Nanoseconds&) const noexcept = default;
  constexpr Nanoseconds& operator+=(Nanoseconds other) noexcept { count += other.count; return *this; }
  constexpr Nanoseconds& operator-=(Nanoseconds other) noexcept { count -= other.count; return *this; }
};

constexpr Nanoseconds operator+(Nanoseconds a, Nanoseconds b) noexcept { return {a.count + b.count}; }
constexpr Nanoseconds operator-(Nanoseconds a, Nanoseconds b) noexcept { return {a.count - b.count}; }
constexpr Nanoseconds operator*(Nanoseconds a, std::int64_t n) noexcept { return {a.count * n}; }
constexpr std::int64_t operator/(Nanoseconds a, Nanoseconds b) noexcept { return a.count / b.count; }

constexpr Nanoseconds microseconds(std::int64_t n) noexcept { return {n * 1'000}; }
constexpr Nanoseconds milliseconds(std::int64_t n) noexcept { return {n * 1'000'000}; }
constexpr Nanoseconds seconds(std::int64_t n) noexcept { return {n * 1'000'000'000}; }

/// The duration in seconds, for control laws and for people.
constexpr double to_seconds(Nanoseconds t) noexcept { return static_cast<double>(t.count) * 1e-9; }

/// Later than every instant that occurs: "no deadline", "never released".
inline constexpr Nanoseconds kNever{INT64_MAX};

}  // namespace chimera
